"""A joint that an equality ties to a measured one follows it, and is felt there."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.cyclic import is_cyclic
from ves_twin.machines.mjcf.parts.ties import Ties
from ves_twin.machines.mjcf.plausible.implausible import implausible
from ves_twin.machines.mjcf.rig.description import RigDescription
from ves_twin.machines.mjcf.rig.machine import Rig

PERIOD, ROWS, ENDS = 0.005, 1600, slice(200, -200)

DRIVE = """<mujoco><compiler angle="radian"/>
  <option timestep="0.0005" integrator="implicitfast"/><worldbody>
  <body name="rotor"><joint name="motor" axis="0 0 1" damping="1e-3"/>
    <inertial pos="0 0 0" mass="0.1" diaginertia="1e-3 1e-3 1e-3"/></body>
  <body name="load" pos="0.1 0 0"><joint name="lever" axis="0 1 0" damping="0.05" {friction}/>
    <inertial pos="0.2 0 0" mass="1" diaginertia="1e-2 1e-2 1e-2"/></body></worldbody>
  <equality><joint joint1="lever" joint2="motor" polycoef="{powers}" solref="0.002 1"/></equality>
  <actuator><motor name="drive" joint="motor"/></actuator></mujoco>"""

SIGNALS = {
    "motor.position": {"columns": ["q"], "unit": "rad", "joint": "motor"},
    "drive.effort": {"columns": ["u"], "unit": "N*m", "actuator": "drive", "noise": 1e-3},
}
LEVER = {"lever.position": {"columns": ["y"], "unit": "rad", "joint": "lever"}}


def driven(
    tmp_path, powers="0.1 0.2 0.02 0 0", friction="", signals=SIGNALS, compare=None, **drive
):
    """A rig, and what a motor with a controller, its gear and its lever did, simulated forward."""
    path = tmp_path / "drive.xml"
    path.write_text(DRIVE.format(powers=powers, friction=friction))
    model = mujoco.MjModel.from_xml_path(str(path))
    data, rows = mujoco.MjData(model), []
    data.qpos[1] = float(powers.split()[0])
    for k in range(ROWS):
        asked = 1.5 * np.sin(1.1 * PERIOD * k) + 0.5 * np.sin(2.3 * PERIOD * k)
        data.ctrl[0] = 2.0 * (asked - data.qpos[0]) - 0.1 * data.qvel[0]
        rows.append((data.qpos[0], data.ctrl[0], data.qpos[1]))
        mujoco.mj_step(model, data, 10)
    q, u, y = np.array(rows).T[:, :, None]
    content = {
        "name": "drive",
        "model": str(path),
        "clock": {"rate": 1.0 / PERIOD},
        "drive": {"mode": "motion", "smoothing": 30.0} | drive,
        "signals": signals,
        "compare": compare or {},
        "typical": {"joint": {"motor": {"effort": 0.4, "speed": 2.0, "travel": 1.8}}},
        "effects": [{"kind": "*", "on": ["*"]}],
    }
    told = {"motor.position": q, "drive.effort": u, "lever.position": y}
    told = {name: told[name] for name in signals}
    recording = Recording(PERIOD * np.arange(ROWS), told, RecordingInfo("measured"))
    return Rig.of(RigDescription.model_validate(content), tmp_path), recording


def left(rig, recording, values=None):
    """Rms of the measured effort [N m] that the model does not need."""
    forward = MjcfForward.of(rig)
    need = forward.simulate(Excitation.of(recording, forward.drive), values or {})
    at = [channel.name for channel in forward.channels].index("drive.effort")
    rest = recording["drive.effort"][ENDS, 0] - need[ENDS, at]
    return float(np.sqrt(np.mean(np.square(rest))))


@pytest.mark.parametrize("friction", ["", 'frictionloss="0.02"'])
@pytest.mark.parametrize("powers", ["0 0.2 0 0 0", "0.1 0.2 0.02 0 0", "0 -0.1 0 0.02 0.01"])
def test_the_motor_needs_what_its_load_needs(tmp_path, powers, friction):
    """To a hundredth of what it gives: rows at 5 ms, and equalities of MuJoCo are soft.

    To 3 % with a dry friction that makes 17 % of it: its turning points are low-passed.
    """
    rig, recording = driven(tmp_path, powers, friction)
    assert left(rig, recording) < (0.03 if friction else 0.01) * np.std(recording["drive.effort"])


def test_a_mass_that_is_wrong_is_felt_at_the_motor(tmp_path):
    rig, recording = driven(tmp_path)
    assert left(rig, recording, {"body_mass@load:mass": 1.1}) > 5.0 * left(rig, recording)


def test_a_load_that_is_measured_is_felt_at_the_motor_as_well(tmp_path):
    rig, recording = driven(tmp_path, signals=SIGNALS | LEVER)
    assert left(rig, recording) < 0.01 * np.std(recording["drive.effort"])


def test_where_the_load_alone_is_measured_its_gear_tells_the_motor(tmp_path):
    effort = {"drive.effort": SIGNALS["drive.effort"]}
    rig, recording = driven(tmp_path, "0.1 0.2 0 0 0", signals=LEVER | effort)
    assert left(rig, recording) < 0.02 * np.std(recording["drive.effort"])


def test_imposed_motion_is_felt_alike(tmp_path):
    """Its load is integrated, and no equality beside it counts twice."""
    effort = {"drive.effort": {"columns": ["u"], "unit": "N*m", "noise": 1e-3}}
    compare = {"drive.effort": {"actuator": "drive"}}
    drive = {"mode": "control", "imposed": ["motor"]}
    rig, recording = driven(tmp_path, signals=SIGNALS | effort, compare=compare, **drive)
    assert left(rig, recording) < 0.02 * np.std(recording["drive.effort"])


def test_a_recording_in_order_is_not_refused(tmp_path):
    rig, recording = driven(tmp_path)
    assert implausible(rig, recording) is None


def test_a_turned_effort_is_told_by_what_the_load_weighs(tmp_path):
    rig, recording = driven(tmp_path)
    turned = {**recording.signals, "drive.effort": -recording["drive.effort"]}
    told = implausible(rig, Recording(recording.time, turned, recording.info))
    assert "the other sign of drive.effort" in told.came


def test_a_bent_tie_cannot_be_turned_round(tmp_path):
    effort = {"drive.effort": SIGNALS["drive.effort"]}
    with pytest.raises(InvalidInputError, match="joint motor, mode 'motion'"):
        _ = driven(tmp_path, signals=LEVER | effort)[0].model


def test_a_chain_of_ties_is_followed_to_its_end_and_no_locked_joint_follows():
    text = """<mujoco><worldbody>{}</worldbody><equality>
      <joint joint1="b" joint2="a" polycoef="0 2 0 0 0"/>
      <joint joint1="b" joint2="c" polycoef="0 4 0 0 0"/></equality></mujoco>"""
    body = '<body><joint name="{}" axis="0 0 1"/><geom size="0.1"/></body>'
    model = mujoco.MjModel.from_xml_string(text.format("".join(map(body.format, "abc"))))
    ties = Ties.of(model, ["a"])
    assert [(one.joint, one.leader) for one in ties.followers] == [("b", "a"), ("c", "b")]
    states = tuple(np.array([[x, 0.0, 0.0]]) for x in (1.0, 10.0, 100.0))
    ties.follow(model, states)
    assert np.array(states)[:, 0] == pytest.approx(np.outer([1.0, 10.0, 100.0], [1.0, 2.0, 0.5]))
    efforts = ties.at_leaders(model, states[0], np.array([[1.0, 10.0, 100.0]]))
    assert efforts[0, 0] == pytest.approx(1.0 + 2.0 * (10.0 + 0.25 * 100.0))
    assert [one.joint for one in Ties.of(model, ["a"], locked=["c"]).followers] == ["b"]
    assert Ties.of(model, ["a"], locked=["c"]).loose == (0, 1)


@pytest.mark.parametrize(
    ("powers", "axis", "cyclic"),
    [("0 0.2 0 0 0", "0 0 1", True), ("0 0.2 0.1 0 0", "0 0 1", False), ("0 0.2", "0 1 0", False)],
    ids=["wheel", "cam", "lever"],
)
def test_where_a_motor_stands_tells_where_its_load_does(powers, axis, cyclic):
    text = DRIVE.format(powers=powers, friction="").replace('axis="0 1 0"', f'axis="{axis}"')
    assert is_cyclic(mujoco.MjModel.from_xml_string(text), "motor") is cyclic
