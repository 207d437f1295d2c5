"""A stream that was changed since it was written: said, and never read as data."""

import io
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.ipc as ipc
import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME, RecordingStream
from ves_twin.core.recording.table import batch_of, schema_of

INFO = RecordingInfo(origin="simulated", scenario="x", seed=7, held={"leg.command": 0.01})
NAMES = ("leg.length", "supply.pressure")
BATCHES, ROWS = 6, 10


def rows(start: int, count: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    time = np.arange(start, start + count) * 0.1
    values = np.random.default_rng(start).normal(size=(count, 7))
    return time, {"leg.length": values[:, :6], "supply.pressure": values[:, 6:]}


@pytest.fixture
def stream(tmp_path) -> Path:
    """A closed stream of BATCHES batches of ROWS rows."""
    with RecordingStream(tmp_path, NAMES, INFO) as written:
        for k in range(BATCHES):
            written.write(*rows(ROWS * k, ROWS))
    return tmp_path / STREAM_NAME


def read(path: Path) -> tuple[np.ndarray, dict[float, np.ndarray], list[str]]:
    """Times, rows by time, and what was said."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        found = load_recording(path)
    values = np.column_stack([found[name] for name in NAMES])
    assert replace(found.info, versions={}) == INFO
    return found.time, dict(zip(found.time, values, strict=True)), [str(w.message) for w in said]


def test_rows_around_a_changed_byte_are_kept_and_those_left_out_are_named(stream):
    content = bytearray(stream.read_bytes())
    content[len(content) * 6 // 10] ^= 0x10
    stream.write_bytes(content)
    time, _, said = read(stream)
    assert len(time) == (BATCHES - 1) * ROWS
    gap = int(np.argmax(np.diff(time)))
    assert len(said) == 1
    assert f"rows after {time[gap]:.6g} s and before {time[gap + 1]:.6g} s are left out" in said[0]
    assert said[0].count("\n") == 0


def test_no_changed_byte_is_read_as_data(stream):
    """Every byte in turn: what is loaded is as written; what is missing is said or was the head."""
    whole, times = stream.read_bytes(), np.arange(BATCHES * ROWS) * 0.1
    written = {}
    for k in range(BATCHES):
        time, signals = rows(ROWS * k, ROWS)
        values = np.column_stack([signals[name] for name in NAMES])
        written |= dict(zip(time, values, strict=True))
    rng = np.random.default_rng(3)
    loaded, refused = 0, 0
    for place in rng.permutation(len(whole))[:600]:
        content = bytearray(whole)
        content[place] ^= 1 << int(rng.integers(8))
        stream.write_bytes(content)
        try:
            time, found, said = read(stream)
        except VesTwinError:
            refused += 1
            continue
        loaded += 1
        for at, values in found.items():
            assert np.array_equal(values, written[at]), place
        assert set(time) <= set(times)
        assert len(time) == len(times) or said, place
    assert loaded > 200
    assert refused > 20


def test_a_stream_without_checksums_is_read_as_before(tmp_path):
    schema, file = schema_of(NAMES, INFO), io.BytesIO()
    with ipc.new_stream(file, schema) as writer:
        for k in range(3):
            writer.write_batch(batch_of(schema, *rows(ROWS * k, ROWS)))
    (tmp_path / STREAM_NAME).write_bytes(file.getvalue())
    time, found, said = read(tmp_path)
    assert len(time) == 3 * ROWS
    assert said == []
    assert np.array_equal(found[0.0], [*rows(0, 1)[1]["leg.length"][0], found[0.0][6]])


def test_a_run_that_is_cut_says_nothing_of_changes(stream):
    whole = stream.read_bytes()
    for left in np.linspace(len(whole) // 2, len(whole) - 9, 40).astype(int):
        stream.write_bytes(whole[:left])
        time, _, said = read(stream)
        assert said == []
        assert len(time) % ROWS == 0


def test_finishing_reads_the_file_that_it_opened(tmp_path):
    """Another file of the name is neither read nor removed."""
    with RecordingStream(tmp_path, NAMES, INFO) as stream:
        stream.write(*rows(0, ROWS))
        (tmp_path / STREAM_NAME).rename(tmp_path / "moved.arrows")
        (tmp_path / STREAM_NAME).write_bytes(b"another")
        stream.finish(INFO)
    assert len(load_recording(tmp_path / FILE_NAME)) == ROWS
    assert (tmp_path / STREAM_NAME).read_bytes() == b"another"
