"""Motors that act on the same joints, as through a belt: each is told its own part."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.transmission import Transmission, arms_of

BELT = """
<mujoco model="belt">
  <option timestep="0.001" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody><body>
    <joint name="one" axis="0 1 0" damping="0.3"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1"/>
    <site name="tip"/>
    <body pos="0.3 0 0">
      <joint name="two" axis="0 1 0" damping="0.05"/>
      <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02" mass="0.5"/>
    </body></body></worldbody>
  <tendon><fixed name="belt">
    <joint joint="one" coef="1"/><joint joint="two" coef="2"/>
  </fixed></tendon>
  <actuator>
    <motor name="own" joint="one" gear="3"/><motor name="far" tendon="belt" gear="0.5"/>
    <motor name="twin" joint="two"/><motor name="jet" site="tip"/>
  </actuator>
</mujoco>
"""

FILE = """
schema = 1
kind = "rig"
name = "belt"
model = "belt.xml"
clock = { column = "t" }
drive = { mode = "motion", smoothing = 20 }
effects = [{ kind = "viscous_friction", on = ["one", "two"] }]
[signals]
one = { columns = ["q1"], unit = "rad", joint = "one" }
two = { columns = ["q2"], unit = "rad", joint = "two" }
%s
[typical.joint]
one = { effort = 1, speed = 3, travel = 1 }
two = { effort = 1, speed = 3, travel = 1 }
"""

SIGNAL = '{0} = {{ columns = ["{0}"], unit = "1", actuator = "{0}", noise = 0.01 }}'


def rig(folder: Path, *motors: str) -> Rig:
    (folder / "belt.xml").write_text(BELT)
    path = folder / "belt.toml"
    path.write_text(FILE % "\n".join(map(SIGNAL.format, motors)))
    return Rig.load(str(path))


def test_commands_that_moved_a_belted_arm_are_those_that_its_motion_needs(tmp_path):
    """To 1 %: positions are differentiated twice behind a low-pass."""
    model = mujoco.MjModel.from_xml_string(BELT)
    data, time = mujoco.MjData(model), 0.002 * np.arange(3000)
    own, far = 0.4 * np.sin(3.0 * time), 0.2 * np.cos(2.3 * time)
    q = np.zeros((len(time), 2))
    for k in range(len(time)):
        q[k] = data.qpos
        for _ in range(2):
            data.ctrl[:2] = own[k], far[k]
            mujoco.mj_step(model, data)
    forward = MjcfForward.of(rig(tmp_path, "own", "far"))
    fed = Excitation("", time, {"one": q[:, :1], "two": q[:, 1:]})
    rows = forward.simulate(fed, {p.name: p.nominal for p in forward.parameters})
    inside = slice(300, -300)
    for column, command in zip(rows.T, (own, far), strict=True):
        assert column[inside] == pytest.approx(command[inside], abs=0.01 * np.ptp(command))


def test_arms_are_those_that_mujoco_applies():
    model = mujoco.MjModel.from_xml_string(BELT)
    data = mujoco.MjData(model)
    for number in range(3):
        data.ctrl[:] = 0.0
        data.ctrl[number] = 1.0
        mujoco.mj_forward(model, data)
        arms = arms_of(model, model.actuator(number).name)
        every = [arms.get(joint, 0.0) for joint in ("one", "two")]
        assert every == pytest.approx(data.qfrc_actuator.tolist())
    assert arms_of(model, "jet") == {}


def test_a_motor_alone_at_its_joint_is_a_group_of_its_own():
    model = mujoco.MjModel.from_xml_string(BELT)
    assert Transmission.of(model, "own", ["own", "twin"]).joints == ("one",)


@pytest.mark.parametrize(
    ("motors", "came"),
    [
        (("far",), "far for one and two"),
        (("own", "far", "twin"), "own and far and twin for one and two"),
        (("own", "jet"), "on a site or body"),
    ],
)
def test_commands_that_a_motion_does_not_tell_are_refused(tmp_path, motors, came):
    with pytest.raises(InvalidInputError, match=came):
        rig(tmp_path, *motors)
