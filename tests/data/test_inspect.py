"""inspect: clocks with their faults, units, and a map that can be used as it stands."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pytest

from ves_twin.data.clock.clock_report import usual_step
from ves_twin.data.draft_map import draft_map
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.inspection_text import inspection_text
from ves_twin.data.mapping.import_map import ImportMap


def lab(path, time, columns, head="t [s]"):
    names = ",".join([head, *columns])
    rows = np.column_stack([time, *columns.values()])
    path.write_text(names + "\n" + "\n".join(",".join(f"{v:.9g}" for v in r) for r in rows) + "\n")
    return path


def test_a_clock_with_gaps_repeats_and_steps_back_is_told(tmp_path):
    time = np.arange(2000) * 0.001
    time = np.delete(time, slice(500, 530))  # a gap of 31 ms
    time[1000] = time[999]
    time[1500] = time[1490]
    (table,) = inspect_log(open_log(lab(tmp_path / "a.csv", time, {"x": np.sin(time)}))).tables
    clock = table.clock
    assert clock.rate == pytest.approx(1000.0, rel=1e-6)
    assert (clock.gaps, clock.repeats, clock.back) == (3, 1, 1)
    assert clock.longest[0].length == pytest.approx(0.031, abs=1e-9)
    assert clock.longest[0].start == pytest.approx(0.499, abs=1e-9)


def test_a_clock_whose_rows_come_unevenly_has_no_gaps_to_list(tmp_path):
    time = np.cumsum(np.where(np.arange(1000) % 3 == 2, 0.01, 0.004))
    log = inspect_log(open_log(lab(tmp_path / "a.csv", time, {"x": np.sin(time)})))
    assert log.tables[0].clock.uneven
    text = inspection_text(log)
    assert "uneven, 166.7 Hz on average, steps up to 0.01 s" in text
    assert "gap" not in text


def test_holes_of_a_clock_are_counted_without_a_warning(tmp_path):
    """Infinities and a NaN that signals, next to one another, as damaged files have them."""
    time = np.arange(400.0) * 1e-3
    time[[7, 8, 9, 200]] = np.inf, np.inf, -np.inf, np.nan
    time[201] = np.array([0x7FF0000000000001], np.uint64).view(float)[0]
    np.savez(tmp_path / "a.npz", t=time, x=np.sin(np.arange(400.0)))
    (table,) = inspect_log(open_log(tmp_path / "a.npz")).tables
    assert (table.clock.missing, table.clock.rows) == (5, 395)
    assert table.clock.rate == pytest.approx(1000.0, rel=1e-6)


def test_pieces_do_not_change_what_is_told(tmp_path, monkeypatch):
    from ves_twin.data.formats import csv_log

    time = np.arange(3000) * 0.01
    columns = {"x [mm]": np.round(np.sin(time), 3), "still": np.ones(3000)}
    path = lab(tmp_path / "a.csv", time, columns)
    whole = inspect_log(open_log(path))
    monkeypatch.setattr(csv_log, "PIECE", 999)
    pieces = inspect_log(open_log(path))
    assert pieces.tables[0].channels == whole.tables[0].channels
    one, other = whole.tables[0].clock, pieces.tables[0].clock
    assert (one.start, one.stop, one.rows, one.gaps) == (other.start, other.stop, other.rows, 0)
    assert one.period == pytest.approx(other.period, rel=1e-9)  # it is that of the first piece


@pytest.mark.parametrize(
    ("head", "scale", "unit", "guessed"),
    [
        ("Time (ms)", 1e3, "ms", False),
        ("timestamp", 1e9, "ns", True),
        ("t_us", 1e6, "us", False),
        ("t", 1.0, "s", True),
    ],
)
def test_the_unit_of_time_is_read_or_guessed(tmp_path, head, scale, unit, guessed):
    epoch = 1.7e9 if unit == "ns" else 0.0
    path = tmp_path / "a.csv"
    rows = [f"{round((epoch + i * 0.01) * scale, 3):.3f},{i % 7}" for i in range(100)]
    path.write_text(f"{head},x\n" + "\n".join(rows) + "\n")
    clock = inspect_log(open_log(path)).tables[0].clock
    assert (clock.unit, clock.guessed) == (unit, guessed)
    assert clock.rate == pytest.approx(100.0, rel=1e-6)


@pytest.mark.parametrize("name", ["posa{}", "q{}", "pos_{} [rad]"])
def test_a_joint_that_only_rises_is_no_clock(tmp_path, name):
    time = np.arange(165) / 50.0
    one, two = (name.format(n) for n in (1, 2))
    rising = time - np.sin(2.0 * time) / 2.1
    path = lab(tmp_path / "a.csv", rising, {two: np.sin(time)}, head=one)
    found = inspect_log(open_log(path))
    assert found.tables[0].clock is None
    assert "no column of the file looks like a time" in draft_map(found)


@pytest.mark.parametrize("name", ["t1", "column_1", "Zeitpunkt"])
def test_a_clock_of_any_name_is_found_though_its_rows_jitter(tmp_path, name):
    steps = 0.02 * (1.0 + 0.4 * np.random.default_rng(1).uniform(-1.0, 1.0, 500))
    time = np.cumsum(steps)
    path = lab(tmp_path / "a.csv", time, {"t2": np.sin(time), "column_2": time**2}, head=name)
    assert inspect_log(open_log(path)).tables[0].clock.column == name


def test_a_clock_that_is_called_by_its_place_is_found_though_rows_are_lost(tmp_path):
    time = 0.02 * np.flatnonzero(np.random.default_rng(1).uniform(size=600) > 0.3)
    path = lab(tmp_path / "a.csv", time, {"column_2": np.sin(time)}, head="column_1")
    assert inspect_log(open_log(path)).tables[0].clock.column == "column_1"


def test_a_counter_of_rows_is_no_clock(tmp_path):
    path = lab(
        tmp_path / "a.csv", np.arange(50), {"x": np.random.default_rng(0).normal(size=50)}, "idx"
    )
    (table,) = inspect_log(open_log(path)).tables
    assert table.clock is None
    assert table.candidates == ("idx",)
    assert "clock: none found" in inspection_text(inspect_log(open_log(path)))


def test_slow_channels_and_missing_rows_are_told(tmp_path):
    time = np.arange(1000) * 0.001
    slow = np.repeat(np.arange(100.0), 10)
    holes = np.where(np.arange(1000) % 100 == 7, np.nan, time)
    inspection = inspect_log(open_log(lab(tmp_path / "a.csv", time, {"s": slow, "h": holes})))
    channels = {c.name: c for c in inspection.tables[0].channels}
    assert channels["h"].missing == 10
    assert channels["s"].changes == pytest.approx(0.1, rel=0.02)
    text = inspection_text(inspection)
    assert "10 missing" in text
    assert "changes at 99" in text
    json.dumps(inspection.to_dict(), allow_nan=False)


def test_a_drafted_map_of_our_own_columns_imports_as_it_stands(tmp_path):
    time = np.arange(300) * 0.01
    columns = {f"leg.length.{i + 1} [mm]": 1000.0 + i + np.sin(time) for i in range(6)}
    path = lab(tmp_path / "a.csv", time, columns)
    draft = draft_map(inspect_log(open_log(path)))
    (tmp_path / "a.toml").write_text(draft)
    recording = import_log(open_log(path), ImportMap.load(tmp_path / "a.toml")).recording
    assert recording["leg.length"].shape == (300, 6)
    # nine printed digits of a metre in millimetres
    assert np.allclose(recording["leg.length"][:, 2], 1.002 + 1e-3 * np.sin(time), atol=1e-8)


def test_a_drafted_map_guesses_in_comments_and_never_twice(tmp_path):
    time = np.arange(100) * 0.01
    names = ("L1 cmd [mm]", "L1 [mm]", "q2_deg", "Fz (N)", "grav_Fz (N)", "motor temp", "Fz2 (N)")
    path = lab(tmp_path / "a.csv", time, {n: np.sin(time) for n in names})
    lines = draft_map(inspect_log(open_log(path))).splitlines()
    goals = [line.split('"')[1] for line in lines if line.startswith("# to = ")]
    assert goals[:5] == [
        *("leg.command.1", "leg.length.1", "arm.q.2", "sensor.wrench.3", "gravity.estimate.3"),
    ]
    assert len(set(goals)) == len(goals)
    assert '# [signals."motor_temp"]   # a signal of your own needs a unit' in lines


def test_two_steps_that_are_not_alike_have_the_step_between_them():
    assert usual_step(np.array([0.0, 1.0, 11.0])) == 5.5


def test_a_table_without_numbers_is_told_as_such(tmp_path):
    feather.write_feather(pa.table({"who": ["a", "b"]}), tmp_path / "a.feather")
    (table,) = inspect_log(open_log(tmp_path / "a.feather")).tables
    assert table.clock is None
    assert [c.kind for c in table.channels] == ["text"]
