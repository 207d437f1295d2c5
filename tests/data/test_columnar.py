"""Parquet and Arrow: statistics instead of reading, streams that were cut."""

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.open_log import open_log

T = np.arange(1000) * 0.01


@pytest.fixture
def lab():
    field = pa.field("force", pa.float32(), metadata={"unit": "N"})
    schema = pa.schema([pa.field("t", pa.float64()), field, pa.field("who", pa.string())])
    return pa.table([T, np.sin(T).astype(np.float32), ["a"] * 1000], schema=schema)


def test_ranges_come_from_the_files_own_statistics(lab, tmp_path):
    pq.write_table(lab, tmp_path / "lab.parquet", row_group_size=300)
    inspection = inspect_log(open_log(tmp_path / "lab.parquet"))
    (table,) = inspection.tables
    assert table.basis == "the file's own statistics"
    assert table.clock.rate == pytest.approx(100.0)
    force = next(c for c in table.channels if c.name == "force")
    assert (force.low, force.high) == pytest.approx((np.sin(T).min(), np.sin(T).max()))
    assert force.unit == "N"
    assert any("who" in fault for fault in inspection.faults)


def test_without_statistics_every_row_is_read(lab, tmp_path):
    pq.write_table(lab, tmp_path / "lab.parquet", write_statistics=False)
    (table,) = inspect_log(open_log(tmp_path / "lab.parquet")).tables
    assert table.basis == "every row"
    assert table.channels[0].high == pytest.approx(np.sin(T).max())


def test_a_feather_file_is_read(lab, tmp_path):
    feather.write_feather(lab, tmp_path / "lab.feather")
    assert np.array_equal(open_log(tmp_path / "lab.feather").read("", ["t"])["t"], T)


def test_a_stream_that_was_cut_keeps_its_whole_batches(tmp_path):
    stream = RecordingStream(tmp_path, ("leg.length",), RecordingInfo("simulated"))
    for k in range(3):
        stream.write(T[:100] + k, {"leg.length": np.ones((100, 6))})
    stream.close()
    path = tmp_path / "recording.arrows"
    path.write_bytes(path.read_bytes()[:-400])
    log = open_log(tmp_path)
    assert len(log.read("", ["t", "leg.length.3"])["t"]) == 200
    assert any("cut after row 200" in fault for fault in log.faults)
    assert log.tables[0].columns[1].unit == "m"


def test_parquet_without_its_footer_says_that_nothing_can_be_found(lab, tmp_path):
    path = tmp_path / "lab.parquet"
    pq.write_table(lab, path)
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(VesTwinError, match="footer"):
        open_log(path)


def test_dates_and_durations_become_seconds(tmp_path):
    stamps = pa.array([0, 1_500_000_000], pa.timestamp("ns"))
    spans = pa.array([0, 250], pa.duration("ms"))
    pq.write_table(pa.table({"when": stamps, "since": spans}), tmp_path / "t.parquet")
    found = open_log(tmp_path / "t.parquet").read("", ["when", "since"])
    assert found["when"][1] == 1.5
    assert found["since"][1] == 0.25
