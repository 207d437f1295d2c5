"""Whatever happens to a file, a look at it ends in what could be read or in one line."""

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest
import scipy.io

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.inspection_text import inspection_text

T = np.arange(300) * 0.01
CASES = 60


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    rows = "\n".join(f"{t:.2f};{np.sin(t):.6f};2024-05-01 12:00:00" for t in T)
    (folder / "a.csv").write_text(f"t [s];x [mm];when\n{rows}\n")
    table = pa.table({"t": T, "x": np.sin(T), "who": ["a"] * 300})
    pq.write_table(table, folder / "a.parquet", row_group_size=100)
    feather.write_feather(table, folder / "a.feather", compression="lz4", chunksize=100)
    scipy.io.savemat(folder / "a.mat", {"t": T, "s": {"x": T, "name": "a"}}, do_compression=True)
    scipy.io.savemat(folder / "b.mat", {"t": T, "c": np.array([T, T], dtype=object)})
    np.savez_compressed(folder / "a.npz", t=T, x=np.outer(T, [1, 2]))
    np.save(folder / "a.npy", np.column_stack([T, T]))
    stream = RecordingStream(folder, ("leg.length",), RecordingInfo("simulated"))
    for k in range(3):
        stream.write(T[:100] + k, {"leg.length": np.ones((100, 6))})
    stream.close()
    return folder


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """A file that was cut, overwritten, or both."""
    found = bytearray(content)
    if rng.random() < 0.5:
        found = found[: rng.integers(0, len(found))]
    for _ in range(rng.integers(0, 6)):
        if found:
            found[rng.integers(0, len(found))] = rng.integers(0, 256)
    if rng.random() < 0.2 and found:
        at = rng.integers(0, len(found))
        found[at : at + 64] = rng.bytes(64)
    return bytes(found)


def look(path):
    """What could be read is told; else the refusal is one line."""
    try:
        told = inspection_text(inspect_log(open_log(path)))
        refused = ""
    except VesTwinError as error:
        told, refused = "", str(error)
    assert told or refused, path
    assert "\n" not in refused, path


NAMES = ("a.csv", "a.parquet", "a.feather", "a.mat", "b.mat", "a.npz", "a.npy", "recording.arrows")


@pytest.mark.filterwarnings("ignore")  # libraries warn of what they find in damaged files
@pytest.mark.parametrize("name", NAMES)
def test_a_damaged_file_ends_in_what_could_be_read_or_in_one_line(written, name, tmp_path):
    content = (written / name).read_bytes()
    for seed in range(CASES):
        path = tmp_path / f"{seed}-{name}"
        path.write_bytes(damaged(content, np.random.default_rng(seed)))
        look(path)


@pytest.mark.filterwarnings("ignore")
def test_so_does_a_damaged_mcap_file(mcap_file, ros2_file, tmp_path):
    for source in (mcap_file(count=60, chunk_size=2048), ros2_file):
        content = source.read_bytes()
        for seed in range(CASES):
            path = tmp_path / "damaged.mcap"
            path.write_bytes(damaged(content, np.random.default_rng(seed)))
            look(path)
