"""A recording whose simulation runs away is simulated in pieces, each from where it was measured."""

from __future__ import annotations

import re

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.compare import compare
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.load import open_machine
from ves_twin.machines.machine import Material, Named
from ves_twin.machines.mjcf.draft.runs_away import runs_away
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.new_machine import new_machine
from ves_twin.report.diagnosis.basis import rests_on

ROCKER = """
<mujoco model="rocker">
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="table">
      <joint name="tilt" axis="0 1 0" damping="0.01"/>
      <inertial pos="0 0 0.005" mass="5" diaginertia="0.3 0.3 0.3"/>
      <body name="wheel">
        <joint name="wheel" axis="0 1 0" damping="2e-4"/>
        <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.002 0.001"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="wheel"/></actuator>
</mujoco>
"""
"""A table that stands on its bearing like a pencil, balanced by a wheel."""

FILE = """
schema = 1
kind = "rig"
name = "rocker"
model = "rocker.xml"
clock = { column = "t [s]" }
drive = { mode = "control", smoothing = 5%s }
tolerances = { damping = "5 %%" }
causes = 1
effects = [
    { kind = "coulomb_friction", on = ["wheel"] },
    { kind = "viscous_friction", on = ["wheel"] },
    { kind = "actuator_gain", on = ["motor"] },
]
[signals]
tilt = { columns = ["tilt [rad]"], unit = "rad", joint = "tilt", noise = 1e-4 }
wheel = { columns = ["wheel speed [rad/s]"], unit = "rad/s", joint = "wheel", of = "speed", noise = 0.05 }
torque = { columns = ["motor torque [N*m]"], unit = "N*m", actuator = "motor" }
[typical.joint]
tilt = { speed = 0.3, travel = 0.2 }
wheel = { effort = 0.3, speed = 100, travel = 100 }
[start]
tilt = { position = "measured", sd = 1e-4, speed_sd = 0.05 }
wheel = { position = "measured", speed_sd = 0.05 }
"""

HEAD = "t [s],tilt [rad],wheel speed [rad/s],motor torque [N*m]"

FRICTION = 0.03
"""Dry friction of the wheel's bearing [N m], which the model lacks."""


def rig_in(folder, horizon=""):
    """The file, with more in its table `drive`."""
    (folder / "rocker.xml").write_text(ROCKER)
    path = folder / "rocker.toml"
    path.write_text(FILE % horizon)
    return path


def logged(folder, seed, seconds=9.0):
    """A log of the table, balanced through the wheel, which has dry friction."""
    model = mujoco.MjModel.from_xml_string(ROCKER)
    model.dof_frictionloss[1] = FRICTION
    model.dof_solref[1] = 0.002, 1.0  # dry, not MuJoCo's creep over 20 ms
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(seed), []
    tones, phases = rng.uniform(0.2, 0.9, 3), rng.uniform(0.0, 6.28, 3)
    for time in np.arange(0.0, seconds, 0.01):
        wanted = 0.03 * np.sum(np.sin(2.0 * np.pi * tones * time + phases))
        angle, speed = data.qpos[0] + 1e-4 * rng.standard_normal(), data.qvel[0]
        torque = 25.0 * (angle - wanted) + 6.0 * speed
        rows.append([time, angle, data.qvel[1] + 0.05 * rng.standard_normal(), torque])
        data.ctrl[0] = torque
        mujoco.mj_step(model, data, 10)
    path = folder / f"log{seed}.csv"
    np.savetxt(path, rows, "%.9g", ",", header=HEAD, comments="")
    return path


def recording_of(rows, period=0.01):
    time = period * np.arange(rows)
    signals = {"tilt": time[:, None], "wheel": 0.0 * time[:, None], "torque": time[:, None]}
    return Recording(time, signals, RecordingInfo("measured", period=period))


@pytest.mark.parametrize(("rows", "count"), [(1000, 5), (1090, 5), (1110, 6), (250, 1), (150, 1)])
def test_pieces_are_of_one_length_near_the_horizon_and_lose_no_row(tmp_path, rows, count):
    rig = Rig.load(str(rig_in(tmp_path, ", horizon = 2")))
    whole = recording_of(rows)
    found = pieces(rig, whole)
    assert len(found) == count
    np.testing.assert_array_equal(np.concatenate([one.time for one in found]), whole.time)
    lengths = [len(one.time) for one in found]
    assert max(lengths) - min(lengths) <= 1


@pytest.mark.parametrize(
    ("horizon", "period", "count"), [(1, 0.01, 6), (1, 0.001, 5), (0.2, 0.01, 30)]
)
def test_pieces_are_longer_where_they_would_have_too_few_rows_of_the_analysis(
    tmp_path, horizon, period, count
):
    rig = Rig.load(str(rig_in(tmp_path, f", horizon = {horizon}")))
    whole = recording_of(round(6.0 / period), period)
    found = pieces(rig, whole)
    assert len(found) == count
    if count < 30:  # those of 0.2 s are refused: more than a third longer is another horizon
        preprocess(MjcfForward.of(rig), found)


def test_a_recording_as_long_as_a_refusal_asks_is_taken(tmp_path):
    forward = MjcfForward.of(Rig.load(str(rig_in(tmp_path))))
    with pytest.raises(InvalidInputError) as refused:
        preprocess(forward, [recording_of(60)], None, 47.0)
    seconds = float(re.search(r"at least 100, so (.*) s:", str(refused.value))[1])
    rows = round(seconds / 0.01) + 1
    preprocess(forward, [recording_of(rows)], None, 47.0)
    with pytest.raises(InvalidInputError, match="at least 100"):
        preprocess(forward, [recording_of(rows - 6)], None, 47.0)


@pytest.mark.parametrize(("rows", "count"), [(286, 2), (186, 1), (500, 5)])
def test_a_horizon_that_has_enough_rows_leaves_no_piece_with_too_few(tmp_path, rows, count):
    """6 s at 47.6 Hz in pieces of 2.1 s were refused as three of 2 s, and 2.1 s asked for."""
    rig = Rig.load(str(rig_in(tmp_path, ", horizon = 2.1")))
    found = pieces(rig, recording_of(rows, 0.021))
    assert len(found) == count
    preprocess(MjcfForward.of(rig), found)


def test_pieces_have_enough_rows_at_the_rate_of_the_machine(tmp_path):
    path = rig_in(tmp_path, ", horizon = 4")
    path.write_text(path.read_text().replace("[signals]", 'rate = "25 Hz"\n[signals]', 1))
    rig = Rig.load(str(path))
    found = pieces(rig, recording_of(1060))
    assert len(found) == 2
    preprocess(MjcfForward.of(rig), found, None, rig.description.rate)


def test_each_piece_has_the_rows_of_its_lead_before_it(tmp_path):
    rig = Rig.load(str(rig_in(tmp_path, ", horizon = 2, lead = 0.1")))
    found = pieces(rig, recording_of(810))
    np.testing.assert_allclose([one.time[0] for one in found], [0.0, 2.0, 4.0, 6.0], atol=1e-9)
    assert [len(one.time) for one in found] == [210] * 4


def test_a_rig_without_a_horizon_keeps_its_recordings_whole(tmp_path):
    whole = recording_of(1000)
    assert pieces(Rig.load(str(rig_in(tmp_path))), whole) == (whole,)


def test_a_joint_whose_start_no_row_tells_is_named(tmp_path):
    path = rig_in(tmp_path, ", horizon = 2")
    path.write_text(
        path.read_text().replace('wheel = { position = "measured"', "wheel = { speed = 3")
    )
    with pytest.raises(InvalidInputError, match=r"start\.wheel"):
        pieces(Rig.load(str(path)), recording_of(1000))


def test_a_joint_that_floats_begins_as_the_model_has_it_so_that_pieces_are_refused(tmp_path):
    path = rig_in(tmp_path, ", horizon = 2")
    plate = '<body name="plate" pos="0 0 1"><freejoint name="plate"/><geom size="0.1"/></body>'
    model = ROCKER.replace("</worldbody>", f"{plate}</worldbody>")
    (tmp_path / "rocker.xml").write_text(model)
    with pytest.raises(InvalidInputError, match="plate, of which no row tells the start"):
        pieces(Rig.load(str(path)), recording_of(1000))


def test_a_horizon_where_motion_is_fed_in_is_refused(tmp_path):
    path = rig_in(tmp_path, ", horizon = 2")
    path.write_text(path.read_text().replace('mode = "control"', 'mode = "motion"'))
    with pytest.raises(InvalidInputError, match="horizon"):
        Rig.load(str(path))


def test_of_a_machine_in_order_its_first_piece_counts(tmp_path):
    """So that five recordings stay five machines."""
    machine = open_machine(str(rig_in(tmp_path, ", horizon = 2")))
    named = tuple(Named("one", recording_of(1000)) for _ in range(2))
    cut = machine.prepare(Material(named[:1], (), (), named)).in_pieces().material
    assert (len(cut.measured), len(cut.commissioning)) == (5, 2)


def test_a_draft_takes_pieces_where_the_model_runs_away_and_says_why(tmp_path):
    log = logged(tmp_path, 1)
    (tmp_path / "rocker.xml").write_text(ROCKER)
    draft = new_machine(tmp_path / "rocker.xml", [log], tmp_path / "my.toml").draft
    assert "over the whole log the model explains" in draft.mode
    told = Rig.load(str(tmp_path / "my.toml")).description
    assert 1.5 <= told.drive.horizon <= 5.0
    assert told.start["wheel"].position == "measured"
    assert min(draft.explained.values()) > 0.1


def test_in_pieces_a_hidden_friction_of_a_machine_that_falls_over_is_found(tmp_path):
    path = rig_in(tmp_path, ", horizon = 1.5")
    machine = open_machine(str(path))
    fit, held = (machine.read(str(logged(tmp_path, seed, 6.0))) for seed in (1, 2))
    told = diagnose([fit], machine, held_out=[held], settings=Settings(nulls=4)).verdict
    found = {f"{cause.effect}@{cause.target}": cause for cause in told.causes}
    (level,) = found["coulomb_friction@wheel"].parameters.values()
    assert level.value == pytest.approx(FRICTION, rel=0.05)
    assert told.gain is not None
    assert told.gain.share > 0.9
    assert "simulated in 4 pieces, each from its own start" in rests_on(told.basis)


def test_compare_predicts_piece_by_piece_what_falls_over_and_says_so(tmp_path):
    log = logged(tmp_path, 1)
    errors, notes = [], []
    for horizon in ("", ", horizon = 1.5", ", horizon = 1.5, lead = 0.1"):
        machine = open_machine(str(rig_in(tmp_path, horizon)))
        (found,) = compare([machine.read(str(log))], machine).recordings
        (tilt,) = [one for one in found.channels if one.name == "tilt"]
        errors.append(tilt.rms)
        notes.append(" ".join(found.notes))
        assert len(found.traces.expected["tilt"]) == len(found.traces.time)
        band = found.traces.reach
        assert not horizon or (band and all(np.all(np.isfinite(sd)) for sd in band.values()))
    assert max(errors[1:]) < 0.1 * errors[0]
    assert "pieces" not in notes[0]
    assert "predicted in 6 pieces of about 1.5 s, each from its measured start" in notes[1]


def simulated(folder, place, friction=0.0, seconds=12.0):
    """The machine with its table's centre at a height, and a log of it on tones of the wheel."""
    (folder / "rocker.xml").write_text(ROCKER.replace("0 0 0.005", f"0 0 {place}"))
    (folder / "rocker.toml").write_text(FILE % "")
    rig = Rig.load(str(folder / "rocker.toml"))
    time = 0.01 * np.arange(int(100 * seconds))
    torque = 0.2 * np.sin(2.0 * np.pi * np.outer(time, [0.31, 0.57])).sum(axis=1)
    begin = {"tilt": 0.0 * time, "wheel": 0.0 * time, "torque": torque}
    signals = {name: column[:, None] for name, column in begin.items()}
    forward = MjcfForward.of(rig)
    fed = Excitation("tones", time, signals)
    rows = forward.simulate(fed, {"coulomb_friction@wheel:level": friction})
    told = {c.signal: rows[:, [k]] for k, c in enumerate(forward.channels)}
    return forward, Recording(time, {**signals, **told}, RecordingInfo("measured", period=0.01))


@pytest.mark.parametrize(
    ("place", "friction", "whole"),
    [(-0.05, 0.0, True), (-0.05, 0.02, True), (-0.01, 0.0, False)],
    ids=["itself", "a friction less", "out of step"],
)
def test_pieces_are_for_what_is_out_of_step_and_not_for_a_size_that_is_off(
    tmp_path, place, friction, whole
):
    """A table hung 5 cm below its bearing, and models of it with one number off."""
    log = simulated(tmp_path, -0.05, friction)[1]
    assert runs_away(simulated(tmp_path, place)[0], log) is not whole
