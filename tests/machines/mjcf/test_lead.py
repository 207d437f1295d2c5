"""The lead of a recording: commands before the row that simulation begins at, still on their way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.compare import compare
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import started
from ves_twin.machines.mjcf.recordings.read import read_recording
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """<mujoco model="slide">
  <option timestep="0.005" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="rod"><joint name="slide" type="slide" axis="1 0 0" damping="2"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="valve" joint="slide"/></actuator>
</mujoco>
"""

TOLD = """schema = 1
kind = "rig"
name = "slide"
model = "slide.xml"
rate = 100
[clock]
column = "t"
[signals.push]
columns = ["u"]
unit = "N"
[signals.place]
columns = ["x"]
unit = "m"
noise = "1 um"
[drive]
mode = "control"
actuators = { valve = "push" }
joints = { slide = "place" }
LEAD
[compare.place]
joint = "slide"
[start.slide]
position = "measured"
sd = "1 um"
[typical.joint.slide]
effort = 1.0
speed = "0.3 m/s"
travel = "0.5 m"
[[effects]]
kind = "actuator_delay"
on = ["valve"]
largest = "0.3 s"
[[effects]]
kind = "stribeck_friction"
on = ["slide"]
"""

STEP, BEGIN, LEAD = 0.01, 200, 40
DELAY = {"actuator_delay@valve:delay": 0.25}
RUBS = {"stribeck_friction@slide:level": 0.1, "stribeck_friction@slide:fall": 0.2}
"""Depends on the speed: stepped row by row, where a delay alone is MuJoCo's own loop."""


def rig(folder, lead=""):
    (folder / "slide.xml").write_text(MODEL)
    path = folder / f"slide{len(lead)}.toml"
    path.write_text(TOLD.replace("LEAD", lead))
    return Rig.load(str(path))


def cut(folder, values, laws=()):
    """Pushes and places of a long run from rest, cut out of its middle."""
    time = STEP * np.arange(600)
    push = np.sin(9.0 * time) + 0.5 * np.sign(np.sin(2.1 * time + 1.0))
    still = {"push": push[:, None], "place": np.zeros((600, 1))}
    plain = rig(folder)
    place = MjcfForward.of(plain).simulate(Excitation("long", time, still), values, False, laws)
    rows = slice(BEGIN - LEAD, None)
    table = np.column_stack([STEP * np.arange(600 - BEGIN + LEAD), push[rows], place[rows, 0]])
    path = folder / "cut.csv"
    np.savetxt(path, table, "%.12g", ",", header="t,u,x", comments="")
    return read_recording(path, plain, None)


def off(one, recording: Recording, values, laws=()):
    forward = MjcfForward.of(one)
    fed = Excitation.of(recording, forward.drive, rate=100.0)
    return forward.simulate(fed, values, False, laws)[:, 0] - recording["place"][:, 0]


def pushes_from(time: float) -> Law:
    """Half a newton from a time on [s]."""
    knots, values = ((0.0, time, time + 0.01, 10.0),), (0.0, 0.0, 0.5, 0.5)
    return Law("slide", LawKind.EFFORT, LawShape.TABLE, ("time",), knots, values)


@pytest.mark.parametrize("values", [DELAY, DELAY | RUBS], ids=["delay", "friction, too"])
def test_commands_of_the_lead_act_when_their_delay_is_over(tmp_path, values):
    recording = cut(tmp_path, values)
    held = np.abs(off(rig(tmp_path), recording, values))
    led = np.abs(off(rig(tmp_path, 'lead = "0.4 s"'), recording, values))
    # the first speed is off a cubic through the first rows: 0.6 mm at the end
    assert np.max(led[LEAD:]) < 1e-3
    assert np.max(held) > 30.0 * np.max(led[LEAD:])


def test_rows_of_the_lead_are_neither_simulated_nor_compared(tmp_path):
    recording = cut(tmp_path, DELAY)
    forward = MjcfForward.of(rig(tmp_path, 'lead = "0.4 s"'))
    fed = Excitation.of(recording, forward.drive, rate=100.0)
    rows = forward.simulate(fed, DELAY)[:, 0]
    assert np.all(rows[:LEAD] == rows[LEAD])
    assert rows[LEAD] == pytest.approx(recording["place"][LEAD, 0], abs=1e-5)
    assert [channel.settling for channel in forward.channels] == [0.4]
    place = fed.drive["place"] + np.where(np.arange(len(rows)) < LEAD, 1.0, 0.0)[:, None]
    shifted = replace(fed, drive={**fed.drive, "place": place})
    assert np.array_equal(forward.simulate(shifted, DELAY)[:, 0], rows)


@pytest.mark.parametrize("values", [{}, RUBS], ids=["compiled", "row by row"])
def test_a_law_of_time_goes_by_the_recordings_clock(tmp_path, values):
    recording = cut(tmp_path, values, (pushes_from(STEP * (BEGIN - LEAD) + 2.0),))
    one, law = rig(tmp_path, 'lead = "0.4 s"'), pushes_from(2.0)
    assert np.max(np.abs(off(one, recording, values, (law,))[LEAD:])) < 1e-3
    late = off(one, recording, values, (pushes_from(2.4),))
    assert np.max(np.abs(late[LEAD:])) > 0.05


def test_what_goes_into_a_denser_logs_low_pass_is_not_compared_either(tmp_path):
    """Half the rate of the log: five rows beyond the lead have some of its rows in them."""
    recording = cut(tmp_path, DELAY)
    forward = MjcfForward.of(rig(tmp_path, 'lead = "0.4 s"'))
    data = preprocess(forward, [recording], rate=50.0)
    shifted = np.where(recording.time < LEAD * STEP - 1e-9, 1.0, 0.0)[:, None]
    moved = {**recording.signals, "place": recording["place"] + shifted}
    other = preprocess(forward, [replace(recording, signals=moved)], rate=50.0)
    kept = data.runs.kept
    assert np.array_equal(data.measured[kept], other.measured[kept])
    assert np.count_nonzero(~kept) == LEAD // 2 + 1


def test_a_lead_that_leaves_too_little_is_refused(tmp_path):
    recording = cut(tmp_path, DELAY)
    one = rig(tmp_path, 'lead = "1 s"')
    with pytest.raises(InvalidInputError, match=r"drive\.lead.*1 s of 4\.39 s.*20 % of each"):
        started(one, [recording])
    with pytest.raises(InvalidInputError, match=r"drive\.lead.*1 s of 4\.39 s.*20 % of each"):
        compare([recording], str(tmp_path / "slide12.toml"))
    assert started(rig(tmp_path, 'lead = "0.4 s"'), [recording], [])[1] == ((recording,), ())


def test_a_lead_asks_for_recorded_commands(tmp_path):
    (tmp_path / "slide.xml").write_text(MODEL)
    path = tmp_path / "motion.toml"
    path.write_text(TOLD.replace("LEAD", 'lead = "1 s"').replace('"control"', '"motion"'))
    with pytest.raises(InvalidInputError, match="mode 'control'"):
        Rig.load(str(path))
