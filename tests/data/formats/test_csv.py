"""Text tables of laboratories: separators, headers, units, and what is damaged."""

import gzip

import numpy as np
import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.data.formats import csv_log
from ves_twin.data.formats.csv_log import CsvLog
from ves_twin.data.formats.log import Kind


@pytest.fixture
def table(tmp_path):
    def write(content, name="lab.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return CsvLog(path)

    return write


ROWS = [(0.0, 1.5, -2.0), (0.1, 2.5, -3.0), (0.2, 3.5, -4.0)]


def text(separator, decimal=".", head="t{s}x [mm]{s}y", end="\n"):
    lines = [head.format(s=separator)] if head else []
    lines += [separator.join(f"{v:.1f}".replace(".", decimal) for v in row) for row in ROWS]
    return end.join(lines) + end


@pytest.mark.parametrize(
    "content",
    [
        text(","),
        text(";"),
        text("\t"),
        text("|"),
        text(" "),
        text(";", ","),
        text("\t", ","),
        text(",", end="\r\n"),
        "\ufeff" + text(","),
        "# bench 3\n# second line, with comma\n" + text(","),
        "% t  x  y\n" + text(" ", head=None),
        text(",").rstrip("\n"),
        '"t","x [mm]","y"\n' + text(",", head=None),
        "t   x   y\n  0.0   1.5  -2.0\n  0.1   2.5  -3.0\n  0.2   3.5  -4.0\n",
    ],
    ids=lambda c: repr(c[:24]),
)
def test_numbers_come_whatever_separates_them(table, content):
    log = table(content)
    names = [c.name for c in log.tables[0].columns]
    assert names[0] == "t"
    assert names[2] == "y"
    found = log.read("", names)
    assert np.array_equal(np.column_stack([found[n] for n in names]), ROWS)
    assert log.faults == ()


@pytest.mark.parametrize(
    ("head", "units"),
    [
        ("Time (ms),L1 [mm],q1_deg", ["ms", "mm", "deg"]),
        ("t,L1,q1\ns,mm,deg", ["s", "mm", "deg"]),
        ("t,L1,q1\n[s],[mm],[°]", ["s", "mm", "deg"]),
        ("t_s,F / N,Tz (Nm)", ["s", "N", "N*m"]),
        ("t,leg.length.1,mystery [furlong]", ["", "", ""]),
    ],
)
def test_units_come_from_the_header(table, head, units):
    log = table(head + "\n1,2,3\n4,5,6\n")
    assert [c.unit for c in log.tables[0].columns] == units


def test_latin_1_headers_are_read(table):
    log = table("t;Winkel [°]\n1;2\n3;4\n".encode("latin-1"))
    assert log.tables[0].columns[1].unit == "deg"


def test_columns_without_a_name_are_numbered_and_doubles_told_apart(table):
    assert [c.name for c in table("1,2\n3,4\n").tables[0].columns] == ["column_1", "column_2"]
    names = [c.name for c in table("t,x,x,\n1,2,3,4\n5,6,7,8\n").tables[0].columns]
    assert names == ["t", "x", "x.2", "column_4"]


@pytest.mark.parametrize(
    "text",
    [
        "Friday\t17:15\tperiod 4 ms\nt\tU\tphi\n0\t1\t2\t\n1\t1\t3\t\n",  # rows alone
        "Friday\t17:15\tperiod 4 ms\nt\tU\tphi\t\n0\t1\t2\n1\t1\t3\n",  # the header alone
    ],
)
def test_a_header_is_found_where_it_or_the_rows_alone_end_with_a_separator(table, text):
    """A recorder's rows had a tab at their ends, and all names were lost without a word."""
    log = table(text)
    assert [c.name for c in log.tables[0].columns][:3] == ["t", "U", "phi"]
    assert np.array_equal(log.read("", ["phi"])["phi"], [2, 3])


def test_rows_that_are_cut_and_cells_that_are_no_numbers_are_counted(table):
    log = table("t,x,y\n0,1,2\n1,OVL,3\n2,4,5\n3,6\n4,,7\n5,8")
    found = log.read("", ["t", "x", "y"])
    assert np.array_equal(found["t"], [0, 1, 2, 4])
    assert np.array_equal(found["x"], [1, np.nan, 4, np.nan], equal_nan=True)
    assert any("x: 1 cells are no numbers" in f for f in log.faults)
    assert any("2 rows have another number of columns" in f for f in log.faults)


def test_dates_become_seconds(table):
    log = table("when,x\n2024-05-01 12:00:00.250,1\n2024-05-01T12:00:00.500,2\n,3\n")
    assert log.tables[0].columns[0].kind is Kind.STAMP
    seconds = log.read("", ["when"])["when"]
    # doubles of seconds since 1970 are good to a quarter of a microsecond
    assert seconds[1] - seconds[0] == pytest.approx(0.25, abs=5e-7)
    assert np.isnan(seconds[2])
    zoned = table("when,x\n2024-05-01T12:00:00Z,1\n2024-05-01T12:00:01Z,2\n")
    assert np.diff(zoned.read("", ["when"])["when"])[0] == 1.0


def test_a_date_that_is_none_and_bytes_that_are_no_text_count_as_missing(table):
    rows = [b"2024-05-01 12:00:%02d,1" % (i % 60) for i in range(60)]
    rows[55:57] = [b"when?,2", b"2024-05-01 12:00:56,\xff\xfe"]
    log = table(b"when,x\n" + b"\n".join(rows) + b"\n")
    found = log.read("", ["when", "x"])
    assert np.isnan(found["when"]).sum() == np.isnan(found["x"]).sum() == 1
    assert found["when"][59] - found["when"][0] == 59.0


def test_pieces_join_to_the_whole(table, monkeypatch):
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(5000, 3))
    content = "t,x,y\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows.tolist())
    monkeypatch.setattr(csv_log, "PIECE", 4096)
    log = table(content)
    found = log.read("", ["y", "t", "x"])
    assert np.array_equal(np.column_stack([found[n] for n in "txy"]), rows)


def test_compressed_text_is_read_and_a_cut_archive_keeps_its_begin(table):
    content = "t,x\n" + "".join(f"{i},{i * 0.5}\n" for i in range(100_000))
    packed = gzip.compress(content.encode())
    whole = table(packed, "lab.csv.gz")
    assert whole.read("", ["t"])["t"][-1] == 99_999.0
    cut = table(packed[: len(packed) // 2], "cut.csv.gz")
    some = cut.read("", ["t"])["t"]
    assert np.array_equal(some, np.arange(len(some)))
    assert any("breaks off" in fault for fault in cut.faults)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("t,x\n", "0 rows"),
        ("just words\nand more\n", "rows of numbers"),
        (b"\xff\xfet\x00,\x00", "UTF-16"),
        (b"\x7fELF\x00\x01\x02", "binary"),
    ],
)
def test_what_is_no_table_gets_one_line(table, content, says):
    with pytest.raises(VesTwinError, match=says) as caught:
        table(content)
    assert "\n" not in str(caught.value)
