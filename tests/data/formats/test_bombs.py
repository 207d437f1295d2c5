"""Small files that unfold to much: refused in one line, with little memory; --limit takes them."""

import gzip
import io
import struct
import subprocess
import sys
import zipfile
import zlib
from pathlib import Path

import lz4.frame
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
import zstandard
from mcap.writer import Writer

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.data.formats import csv_log
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.inspect_log import inspect_log

HELD = 800_000_000
"""Bytes that the bombs unfold to."""

PEAK = 600.0
"""Memory that a refusal may take [MiB]: the program's own 200, the limit twice, and room."""

RUN = """
import sys
from pathlib import Path
from ves_twin.cli.main import main
code = main(sys.argv[1:])
words = Path("/proc/self/status").read_text().split()
print(int(words[words.index("VmHWM:") + 1]) / 1024)
sys.exit(code)
"""

BLOCK = b"\0" * 8_000_000


def deflated(head: bytes, form: int) -> bytes:
    packer = zlib.compressobj(1, zlib.DEFLATED, form)
    parts = [packer.compress(head)]
    parts += [packer.compress(BLOCK) for _ in range(HELD // len(BLOCK))]
    return b"".join([*parts, packer.flush()])


def mat_bomb(path: Path) -> None:
    def element(number, data):
        return struct.pack("<II", number, len(data)) + data + b"\0" * (-len(data) % 8)

    dims = struct.pack("<ii", HELD // 8, 1)
    inner = element(6, struct.pack("<II", 6, 0)) + element(5, dims) + element(1, b"x")
    inner += struct.pack("<II", 9, HELD)
    packed = deflated(struct.pack("<II", 14, len(inner) + HELD) + inner, 15)
    head = b"MATLAB 5.0 MAT-file".ljust(116) + b"\0" * 8 + struct.pack("<H", 0x0100) + b"IM"
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)


def npz_bomb(path: Path) -> None:
    head = io.BytesIO()
    kind = {"descr": "<f8", "fortran_order": False, "shape": (HELD // 8,)}
    np.lib.format.write_array_header_1_0(head, kind)
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("x.npy", "w", force_zip64=True) as member,
    ):
        member.write(head.getvalue())
        for _ in range(HELD // len(BLOCK)):
            member.write(BLOCK)


def line_bomb(path: Path) -> None:
    rows = b"t,x\n" + b"".join(b"%d,1\n" % i for i in range(20_000))
    path.write_bytes(deflated(rows, 31))


def rows_bomb(path: Path) -> None:
    rows = b"0.5,1\n" * 1_000_000
    with gzip.open(path, "wb", 1) as file:
        file.write(b"t,x\n")
        for _ in range(HELD // len(rows)):
            file.write(rows)


def mcap_bomb(path: Path, name: str, packer) -> None:
    """A chunk that holds one record of a kind that is passed over, then an ordinary file."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/a", "json", writer.register_schema("a", "", b""))
        for i in range(100):
            writer.add_message(channel, i, b'{"x": 1.0}', i)
        writer.finish()
    content = path.read_bytes()
    record = struct.pack("<BQ", 0x80, len(BLOCK) - 9) + BLOCK[9:]
    parts = [packer.compress(record) for _ in range(HELD // len(record))]
    data = b"".join([*parts, packer.flush()])
    if name == "lz4":
        data = lz4.frame.LZ4FrameCompressor().begin() + data
    body = struct.pack("<QQQII", 0, 0, HELD, 0, len(name)) + name.encode()
    body += struct.pack("<Q", len(data)) + data
    begin = content.index(b"\x06", 8)  # the first chunk
    path.write_bytes(content[:begin] + struct.pack("<BQ", 6, len(body)) + body + content[begin:])


def lz4_bomb(path: Path) -> None:
    packer = lz4.frame.LZ4FrameCompressor()
    packer.begin()
    mcap_bomb(path, "lz4", packer)


def parquet_bomb(path: Path) -> None:
    column = pa.array(np.zeros(HELD // 8))
    pq.write_table(pa.table({"t": column}), path, use_dictionary=False, compression="zstd",
                   row_group_size=HELD)  # fmt: skip


BOMBS = {
    "bomb.mat": (mat_bomb, "unfolded"),
    "bomb.npz": (npz_bomb, "unfolded"),
    "line.csv.gz": (line_bomb, "line"),
    "rows.csv.gz": (rows_bomb, "unfolded"),
    "zstd.mcap": (
        lambda path: mcap_bomb(path, "zstd", zstandard.ZstdCompressor(1).compressobj(size=HELD)),
        "unfolded",
    ),
    "lz4.mcap": (lz4_bomb, "unfolded"),
    "bomb.parquet": (parquet_bomb, "unfolded"),
}


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="peak memory is read from /proc")
@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_in_one_line_with_little_memory(name, tmp_path):
    make, limit = BOMBS[name]
    make(tmp_path / name)
    assert (tmp_path / name).stat().st_size < 4_000_000
    command = [sys.executable, "-c", RUN, "inspect", str(tmp_path / name)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert f"--limit {limit}=" in done.stderr
    assert float(done.stdout) < PEAK


ZEROS = np.zeros(500_000)
"""4 MB that pack to some kB."""

FILES = {
    "a.npz": lambda path: np.savez_compressed(path, t=ZEROS),
    "a.mat": lambda path: scipy.io.savemat(path, {"t": ZEROS}, do_compression=True),
    "a.parquet": lambda path: pq.write_table(
        pa.table({"t": ZEROS}), path, use_dictionary=False, compression="zstd"
    ),
    "a.csv.gz": lambda path: path.write_bytes(gzip.compress(b"t,x\n" + b"0.5,1\n" * 700_000)),
    "a.mcap": lambda path: write_mcap(path, b'{"x": 1}' + b" " * 40_000, 100),
}


def write_mcap(path: Path, message: bytes, count: int) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/a", "json", writer.register_schema("a", "", b""))
        for i in range(count):
            writer.add_message(channel, i, message, i)
        writer.finish()


@pytest.mark.parametrize("name", FILES)
def test_what_a_file_may_unfold_to_can_be_set(name, tmp_path):
    path = tmp_path / name
    FILES[name](path)
    with pytest.raises(InvalidInputError, match="--limit unfolded="):
        inspect_log(open_log(path, Limits.of(["unfolded=1MB"])))
    (table,) = inspect_log(open_log(path, Limits.of(["unfolded=0.01GB"]))).tables
    assert table.rows >= 100


def test_a_message_and_a_line_have_limits_of_their_own(tmp_path, monkeypatch):
    monkeypatch.setattr(csv_log, "PIECE", 4096)
    write_mcap(tmp_path / "a.mcap", b'{"x": 1, "y": "' + b"y" * 50_000 + b'"}', 3)
    with pytest.raises(InvalidInputError, match="--limit message="):
        inspect_log(open_log(tmp_path / "a.mcap", Limits.of(["message=40kB"])))
    rows = "t,x\n" + "".join(f"{i},1\n" for i in range(50_000))
    (tmp_path / "a.csv").write_text(rows + "5" * 50_000 + "\n" + rows[4:])
    with pytest.raises(InvalidInputError, match="--limit line="):
        inspect_log(open_log(tmp_path / "a.csv", Limits.of(["line=40kB"])))


def test_a_byte_of_json_counts_four_times(tmp_path):
    write_mcap(tmp_path / "a.mcap", b'{"x": [' + b"[]," * 3_000_000 + b"0]}", 1)
    with pytest.raises(InvalidInputError, match="--limit message="):
        inspect_log(open_log(tmp_path / "a.mcap"))
    assert inspect_log(open_log(tmp_path / "a.mcap", Limits.of(["message=40MB"]))).tables


def test_a_large_file_may_hold_many_times_its_size(tmp_path):
    path = tmp_path / "a.npy"
    np.save(path, np.arange(1000.0))
    limits = Limits.of(["unfolded=1B"])
    assert inspect_log(open_log(path, limits)).tables[0].rows == 1000


@pytest.mark.parametrize(
    ("word", "says"),
    [("unfold=1GB", "did you mean 'unfolded'"), ("line=much", "a size"), ("line=-1MB", "a size")],
)
def test_a_limit_that_is_none_gets_one_line(word, says):
    with pytest.raises((UnknownNameError, InvalidInputError), match=says):
        Limits.of([word])
