"""Parquet and Arrow: statistics instead of reading, streams that were cut."""

from datetime import time
from decimal import Decimal

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest

from ves_twin.core.errors import InvalidInputError, VesTwinError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.data.formats.log import Kind
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.mapping.import_map import ImportMap

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


@pytest.fixture
def kinds():
    """Columns of every kind that a laboratory's files have; two of one name."""
    names = [
        "day",
        "clock",
        "half",
        "list",
        "struct",
        "bytes",
        "word",
        "few",
        "x",
        "x",
        "dec",
        "x.y",
    ]
    columns = [
        pa.array([0, 1, 2], pa.date32()),
        pa.array([time(0, 0, i) for i in range(3)], pa.time64("us")),
        pa.array(np.arange(3, dtype=np.float16)),
        pa.array([[1.0, 2.0]] * 3),
        pa.array([{"a": 1, "b": 2}] * 3),
        pa.array([b"x"] * 3),
        pa.array(["1", "2", "1"]).dictionary_encode(),
        pa.array([0.5, 1.5, 0.5]).dictionary_encode(),
        pa.array([1, 2, 3]),
        pa.array([4.0, 5.0, None]),
        pa.array([Decimal("1.5")] * 3),
        pa.array([7, 8, 9]),
    ]
    return pa.Table.from_arrays(columns, names=names)


WRITERS = {"a.parquet": pq.write_table, "a.feather": feather.write_feather}


@pytest.mark.parametrize("name", WRITERS)
def test_every_kind_of_column_is_read_where_it_means_a_number(kinds, name, tmp_path):
    WRITERS[name](kinds, tmp_path / name)
    log = open_log(tmp_path / name)
    columns = {c.name: c for c in log.tables[0].columns}
    assert list(columns) == [*kinds.column_names[:9], "x.2", "dec", "x.y"]
    texts = [n for n, c in columns.items() if c.kind is Kind.TEXT]
    assert texts == ["list", "struct", "bytes", "word"]
    found = log.read("", [n for n in reversed(columns) if n not in texts])
    wanted = {
        "day": [0, 86400, 172800], "clock": [0, 1, 2], "half": [0, 1, 2], "few": [0.5, 1.5, 0.5],
        "x": [1, 2, 3], "x.2": [4, 5, np.nan], "dec": [1.5, 1.5, 1.5], "x.y": [7, 8, 9],
    }  # fmt: skip
    assert set(found) == set(wanted)
    for column, values in wanted.items():
        assert np.array_equal(found[column], values, equal_nan=True), column
    ranges = {c.name: (c.low, c.high) for c in inspect_log(log).tables[0].channels}
    assert ranges["half"] == (0.0, 2.0)
    assert ranges["x.y"] == (7.0, 9.0)


def test_the_files_own_ranges_are_those_of_their_column_beside_nested_ones(kinds, tmp_path):
    pq.write_table(kinds.select(["struct", "x.y"]), tmp_path / "a.parquet")
    (table,) = inspect_log(open_log(tmp_path / "a.parquet")).tables
    assert table.basis == "the file's own statistics"
    assert [(c.low, c.high) for c in table.channels if c.name == "x.y"] == [(7.0, 9.0)]


@pytest.mark.parametrize("column", ["list", "struct", "bytes", "word"])
@pytest.mark.parametrize("name", WRITERS)
def test_a_clock_that_holds_no_numbers_is_refused_in_one_line(kinds, name, column, tmp_path):
    WRITERS[name](kinds, tmp_path / name)
    told = (
        f'[clock]\ncolumn = "{column}"\n[[channel]]\nfrom = "x.y"\nto = "leg.length.1"\nunit = "m"'
    )
    (tmp_path / "map.toml").write_text(f"schema = 1\n{told}\n")
    with pytest.raises(InvalidInputError, match=f"{column}: got 'a text"):
        import_log(open_log(tmp_path / name), ImportMap.load(tmp_path / "map.toml"))


@pytest.mark.parametrize("column", ["day", "clock", "half", "few"])
def test_a_clock_of_any_kind_of_number_can_be_imported_by(kinds, column, tmp_path):
    pq.write_table(kinds, tmp_path / "a.parquet")
    told = f'[clock]\ncolumn = "{column}"\nunit = "s"\nbackward = "drop"\n'
    told += '[[channel]]\nfrom = "x.y"\nto = "leg.length.1"\nunit = "m"'
    (tmp_path / "map.toml").write_text(f"schema = 1\n{told}\n")
    found = import_log(open_log(tmp_path / "a.parquet"), ImportMap.load(tmp_path / "map.toml"))
    step = {"day": 86400.0}.get(column, 1.0)
    assert np.diff(found.recording.time)[0] == step


def test_stamps_beyond_nanoseconds_are_read(tmp_path):
    far = pa.array([0, 10**11], pa.timestamp("s"))  # the year 5138
    feather.write_feather(pa.table({"when": far}), tmp_path / "a.feather")
    assert open_log(tmp_path / "a.feather").read("", ["when"])["when"][1] == 1e11
