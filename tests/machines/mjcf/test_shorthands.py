"""Shorthands of a machine's file mean what the long form says, and logs are read as they come."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from two_link import MODEL

from ves_twin.core.errors import VesTwinError
from ves_twin.machines.mjcf.recordings.columns import held, read_rig_recording
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.extend import write_rig
from ves_twin.machines.mjcf.rig.machine import Rig

SHORT = """
schema = 1
kind = "rig"
name = "two_link"
model = "two_link.xml"
clock = { column = "t" }
drive = { mode = "control" }
tolerances = { mass = "5 %", damping = 0.2 }
effects = [{ kind = "*", on = ["*"] }]

[signals]
"rail.position" = { columns = ["x"], unit = "mm", scale = -1, joint = "rail", noise = 1e-5 }
"swing.position" = { columns = ["a"], unit = "deg", joint = "swing", noise = 1e-4 }
"swing.speed" = { columns = ["w"], unit = "rad/s", joint = "swing", of = "speed", noise = 0.01 }
"drive.effort" = { columns = ["f"], unit = "N", actuator = "drive" }

[typical.joint]
rail = { effort = 20, speed = 0.5, travel = 0.5 }
swing = { effort = 2, speed = 1, travel = 1 }
"""

ARM = 0.8
"""Mass of the arm of the two-link machine [kg]."""

LOG = "t,x,a,w,f\n" + "\n".join(f"{0.01 * k:.2f},{k},{2 * k},{3 * k},{k % 7}" for k in range(100))


def written(folder: Path, old: str = "", new: str = "", log: str = LOG) -> Rig:
    (folder / "two_link.xml").write_text(MODEL)
    (folder / "log.csv").write_text(log)
    assert old in SHORT
    (folder / "short.toml").write_text(SHORT.replace(old, new, 1) if old else SHORT)
    return Rig.load(str(folder / "short.toml"))


def targets(rig: Rig, kind: str) -> set[str]:
    return {h.target for h in rig.hypotheses if h.effect == kind}


def test_a_signal_that_says_its_place_is_compared_or_fed_in_by_the_mode(tmp_path):
    told = written(tmp_path).description
    assert told.drive.joints == {"rail": "rail.position", "swing": "swing.position"}
    assert told.drive.actuators == {"drive": "drive.effort"}
    assert told.compare["swing.speed"].of == "speed"
    assert told.compare["drive.effort"].actuator == "drive"


def test_a_unit_of_the_lab_becomes_si_with_its_scale(tmp_path):
    recording = read_rig_recording(tmp_path / "log.csv", written(tmp_path))
    assert recording["rail.position"][40, 0] == pytest.approx(-0.040)
    assert recording["swing.position"][45, 0] == pytest.approx(np.pi / 2.0)


def test_a_tolerance_is_a_share_of_each_value_that_the_model_has(tmp_path):
    rig = written(tmp_path)
    sds = {(s.element[1], s.attribute): s.sd for s in rig.description.parameters}
    assert sds["cart", "mass"] == pytest.approx(0.15)
    assert sds["arm", "mass"] == pytest.approx(0.05 * ARM)
    assert sds["rail", "damping"] == pytest.approx(0.8)
    assert ("rail", "frictionloss") not in sds


def test_a_setting_of_its_own_comes_before_a_tolerance(tmp_path):
    own = 'parameters = [{ body = "cart", attribute = "mass", sd = "1 g" }]\ndrive ='
    sds = {
        (s.element[1], s.attribute): s.sd
        for s in written(tmp_path, "drive =", own).description.parameters
    }
    assert (sds["cart", "mass"], sds["arm", "mass"]) == ("1 g", pytest.approx(0.05 * ARM))


def test_every_effect_sits_where_typical_sizes_are_known_and_commands_are_fed_in(tmp_path):
    rig = written(tmp_path)
    assert targets(rig, "coulomb_friction") == {"rail", "swing"}
    assert not targets(rig, "friction_behind_gap")  # a law of four numbers is asked for by name
    assert targets(rig, "actuator_gain") == {"drive"}  # nothing is fed to the hinge's motor
    assert targets(rig, "body_mass") == {"cart", "arm", "hook"}
    assert targets(rig, "body_place") == {"hook.x", "hook.y", "hook.z"}  # on what turns
    assert targets(rig, "body_inertia") == {"arm", "hook"}  # the cart only slides
    assert targets(rig, "sensor_gain") == {
        f"{s}.1" for s in rig.description.compare if "effort" not in s
    }
    without = "swing = { effort = 2, speed = 1, travel = 1 }"
    assert targets(written(tmp_path, without, ""), "coulomb_friction") == {"rail"}


def test_an_entry_of_its_own_comes_before_every_effect(tmp_path):
    own = '{ kind = "backlash", on = ["rail"], largest = "3 mm" }, { kind = "*"'
    rig = written(tmp_path, '{ kind = "*"', own)
    (gap,) = (h for h in rig.hypotheses if (h.effect, h.target) == ("backlash", "rail"))
    assert gap.largest == (0.003,)
    assert targets(rig, "backlash") == {"rail", "swing"}


def test_an_effect_of_an_effort_that_is_compared_is_told_of_its_actuator_alone(tmp_path):
    both = '"hinge.effort" = { columns = ["f"], unit = "N*m", actuator = "hinge", noise = 1 }'
    text = SHORT.replace("[typical.joint]", f"{both}\n\n[typical.joint]").replace(
        "control", "motion"
    )
    (tmp_path / "two_link.xml").write_text(MODEL)
    (tmp_path / "short.toml").write_text(text)
    rig = Rig.load(str(tmp_path / "short.toml"))
    assert targets(rig, "actuator_gain") == {"drive", "hinge"}
    assert not targets(rig, "sensor_gain")
    assert not targets(rig, "sensor_delay")


def test_what_is_written_over_a_short_file_says_only_what_changed(tmp_path):
    rig = written(tmp_path)
    write_rig(rig, tmp_path / "again.toml")
    assert "parameters" not in (tmp_path / "again.toml").read_text()
    assert Rig.load(str(tmp_path / "again.toml")).identity == rig.identity


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('mass = "5 %"', 'mas = "5 %"', "did you mean 'mass'"),
        ('mass = "5 %"', 'mass = "5 kg"', "dimensionless"),
        ('kind = "*"', 'kind = "backlsh"', "did you mean 'backlash'"),
        ('{ column = "t" }', "{ scale = 1 }", "either column or rate"),
        (
            "[typical.joint]",
            '[compare]\n"rail.position" = { joint = "rail" }\n[typical.joint]',
            "already",
        ),
        ('unit = "mm"', 'unit = "deg"', "m, as joint rail has it"),
    ],
)
def test_a_wrong_shorthand_is_answered_with_one_line(tmp_path, old, new, words):
    with pytest.raises(VesTwinError, match=words) as caught:
        written(tmp_path, old, new)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "log",
    [LOG.replace(",", ";"), LOG.replace("t,x,a,w,f", "t,x,a,w,f\ns,mm,deg,rad/s,N")],
    ids=["semicolons", "a row of units"],
)
def test_a_log_is_read_however_it_is_written(tmp_path, log):
    rig = written(tmp_path)
    plain = read_rig_recording(tmp_path / "log.csv", rig)
    (tmp_path / "log.csv").write_text(log)
    assert np.array_equal(
        read_rig_recording(tmp_path / "log.csv", rig)["rail.position"], plain["rail.position"]
    )


def test_a_log_without_a_header_has_numbered_columns(tmp_path):
    names = {"t": "1", "x": "2", "a": "3", "w": "4", "f": "5"}
    text = SHORT
    for name, number in names.items():
        text = text.replace(f'["{name}"]', f'["column_{number}"]')
        text = text.replace(f'column = "{name}"', f'column = "column_{number}"')
    (tmp_path / "two_link.xml").write_text(MODEL)
    (tmp_path / "short.toml").write_text(text)
    (tmp_path / "log.csv").write_text(LOG.partition("\n")[2])
    recording = read_rig_recording(tmp_path / "log.csv", Rig.load(str(tmp_path / "short.toml")))
    assert recording["drive.effort"][5, 0] == 5.0


def test_a_log_of_numpy_is_read_with_the_rate_of_the_file(tmp_path):
    rows = np.array([[float(c) for c in line.split(",")] for line in LOG.splitlines()[1:]])
    np.savez(
        tmp_path / "log.npz", **{n: rows[:, i] for i, n in enumerate(("t", "x", "a", "w", "f"))}
    )
    rig = written(tmp_path, 'clock = { column = "t" }', "clock = { rate = 50 }")
    recording = read_rig_recording(tmp_path / "log.npz", rig)
    assert np.ptp(np.diff(recording.time)) < 1e-12
    assert recording.time[1] == pytest.approx(0.02)
    assert recording["rail.position"][40, 0] == pytest.approx(-0.040)


def test_a_formula_of_columns_is_a_column(tmp_path):
    rig = written(tmp_path, 'columns = ["f"]', 'columns = ["2 * f - x / 4"]')
    recording = read_rig_recording(tmp_path / "log.csv", rig)
    assert recording["drive.effort"][8, 0] == pytest.approx(2 * 1 - 8 / 4)


@pytest.mark.parametrize("cell", ["", "n/a"])
@pytest.mark.parametrize("start", [1, 3, 17, 40, 64, 96])
def test_a_few_cells_without_a_number_are_filled_and_said(tmp_path, cell, start):
    """Each column from its own rows: what lacks a position keeps its effort."""
    lines = LOG.splitlines()
    for k in range(start, start + 4):
        lines[k] = lines[k].replace(f",{k - 1},", f",{cell},", 1)
    whole = read_rig_recording(tmp_path / "log.csv", written(tmp_path, log=LOG))
    recording = read_rig_recording(tmp_path / "log.csv", written(tmp_path, log="\n".join(lines)))
    assert recording.time == pytest.approx(whole.time)
    assert np.array_equal(recording["drive.effort"], whole["drive.effort"])
    if start > 1 and start + 4 < len(lines):
        assert recording["rail.position"] == pytest.approx(whole["rail.position"])
    (said,) = recording.info.imported["suspected"]
    assert said.startswith("log.csv: 4 rows lack a number")


@pytest.mark.parametrize("start", range(20, 60, 3))
@pytest.mark.parametrize("jitter", [0.0, 5e-4])
def test_four_rows_that_are_not_there_are_read_over_wherever_they_are(tmp_path, start, jitter):
    rng = np.random.default_rng(start)
    time = 0.01 * np.arange(100) + rng.uniform(-jitter, jitter, 100)
    rows = [k for k in range(100) if not start <= k < start + 4]
    log = "t,x,a,w,f\n" + "\n".join(f"{time[k]:.6f},{1000 * time[k]:.4f},0,0,{k}" for k in rows)
    recording = read_rig_recording(tmp_path / "log.csv", written(tmp_path, log=log))
    assert np.ptp(np.diff(recording.time)) < 1e-9
    assert recording["rail.position"][:, 0] == pytest.approx(-recording.time, abs=1e-5)


def test_a_column_that_lacks_many_numbers_is_refused(tmp_path):
    lines = LOG.splitlines()
    for k in range(3, 100, 7):
        lines[k] = lines[k].replace(f",{k - 1},", ",,", 1)
    with pytest.raises(VesTwinError, match=r"14 empty rows.* 10% in all at most"):
        read_rig_recording(tmp_path / "log.csv", written(tmp_path, log="\n".join(lines)))


def test_efforts_belong_to_the_motion_where_that_is_fed_in_and_are_held_else(tmp_path):
    rig = written(tmp_path)
    told = rig.description
    motion = told.model_copy(update={"drive": told.drive.model_copy(update={"mode": Mode.MOTION})})
    assert held(rig, "drive.effort")
    assert not held(replace(rig, description=motion), "drive.effort")
    assert not held(rig, "rail.position")


def test_a_window_leaves_out_empty_rows_before_they_are_refused(tmp_path):
    lines = LOG.splitlines()
    for k in range(3, 8):
        lines[k] = lines[k].replace(f",{k - 1},", ",,", 1)
    rig = written(tmp_path, log="\n".join(lines))
    with pytest.raises(VesTwinError, match=r"5 empty rows, the first is row 3 of .*window"):
        read_rig_recording(tmp_path / "log.csv", rig)
    rig = written(tmp_path, "drive =", 'window = { start = "0.1 s" }\ndrive =', "\n".join(lines))
    recording = read_rig_recording(tmp_path / "log.csv", rig)
    assert (len(recording), recording["rail.position"][0, 0]) == (90, pytest.approx(-0.010))


@pytest.mark.parametrize("jitter", [2e-5, 5e-4, 2e-3])
def test_jitter_moves_no_effort_against_the_motion(tmp_path, jitter):
    """Held from the newest stamp, each effort that is stamped late would be that of before."""
    rng = np.random.default_rng(5)
    time = 0.01 * np.arange(400) + rng.uniform(-jitter, jitter, 400)
    time[0] = 0.0
    log = "t,x,a,w,f\n" + "\n".join(
        f"{t:.6f},{1000 * np.sin(t):.6f},0,0,{np.sin(3.0 * t):.6f}" for t in time
    )
    recording = read_rig_recording(tmp_path / "log.csv", written(tmp_path, log=log))
    effort, true = recording["drive.effort"][:, 0], np.sin(3.0 * recording.time)
    slope = 3.0 * np.cos(3.0 * recording.time)
    late = float(slope @ (true - effort)) / float(slope @ slope)
    assert abs(late) < 1e-3  # of a row of 10 ms: what is left of the jitter, averaged


def test_stamps_that_jitter_are_read_at_even_rows_commands_by_their_mean_over_each(tmp_path):
    """The nearest row's command doubled the error of a right model (a servo at 47 Hz)."""
    rng = np.random.default_rng(5)
    time = 0.01 * np.arange(100) + rng.uniform(0.0, 0.002, 100)
    log = "t,x,a,w,f\n" + "\n".join(
        f"{t:.6f},{1000 * np.sin(t):.6f},0,0,{k}" for k, t in enumerate(time)
    )
    recording = read_rig_recording(tmp_path / "log.csv", written(tmp_path, log=log))
    assert np.ptp(np.diff(recording.time)) < 1e-9
    assert recording["rail.position"][:, 0] == pytest.approx(-np.sin(recording.time), abs=2e-5)
    fine = np.arange(time[0], time[-1], 1e-5)
    rows = np.searchsorted(recording.time, fine, "right") - 1
    whole = np.bincount(rows, np.searchsorted(time, fine, "right") - 1.0) / np.bincount(rows)
    effort = recording["drive.effort"][:-2, 0]
    assert effort == pytest.approx(whole[: len(effort)], abs=5e-3)
    assert "jitter" in str(recording.info.imported["notes"])
