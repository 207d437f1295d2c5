"""What halving a model's step changes tells how far the step puts its prediction off."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.new_machine import new_machine

SWING = """
<mujoco model="swing">
  <option timestep="{step}" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body>
      <joint name="hinge" axis="0 1 0" damping="0.02"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02" mass="0.5"/>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="hinge"/></actuator>
</mujoco>
"""

FILE = """
schema = 1
kind = "rig"
name = "swing"
model = "swing.xml"
clock = { column = "time" }
drive = { mode = "control" }
effects = [{ kind = "viscous_friction", on = ["hinge"] }]
[signals]
angle = { columns = ["angle"], unit = "rad", joint = "hinge", noise = 0.001 }
torque = { columns = ["torque"], unit = "N*m", actuator = "motor" }
[typical.joint]
hinge = { effort = 0.5, speed = 3.0, travel = 0.5 }
[start]
hinge = { position = 0.0, speed = 0.0 }
"""

FINE = 1e-5
"""Step [s] whose error is nothing beside that of those that are tried."""

NOISE = 0.001
"""Of the angle [rad]."""


@pytest.fixture
def forward(tmp_path):
    """The swing with a given step [s]."""

    def of(step):
        (tmp_path / "swing.xml").write_text(SWING.format(step=step))
        (tmp_path / "swing.toml").write_text(FILE)
        return MjcfForward.of(Rig.load(str(tmp_path / "swing.toml")))

    return of


@pytest.mark.parametrize("step", [0.01, 0.002])
def test_it_is_what_a_fine_step_changes_to_first_order(forward, step):
    time = np.arange(0.0, 4.0, 0.02)
    torque = 0.2 * np.sin(2.0 * np.pi * 0.4 * time)[:, None]
    programme = Excitation("swing", time, {"torque": torque})
    runs = Runs(forward(step), (programme,), (0,))
    told = linearise(runs, runs.origin).step_error
    fine = Runs(forward(FINE), (programme,), (0,))
    true = fine.one(fine.origin) - runs.one(runs.origin)
    bent = 2.0 * step / 0.02  # of second order, beside this motion's fastest change of 20 ms
    assert np.linalg.norm(told - true) < bent * np.linalg.norm(true)
    assert np.linalg.norm(true) > 0.0


def test_a_draft_tells_a_step_that_is_coarse_for_its_log(tmp_path):
    model = mujoco.MjModel.from_xml_string(SWING.format(step=FINE))
    data, rows, rng = mujoco.MjData(model), [], np.random.default_rng(4)
    for time in np.arange(0.0, 4.0, 0.02):
        data.ctrl[0] = 0.2 * np.sin(2.0 * np.pi * 0.4 * time)
        rows.append([time, data.qpos[0] + NOISE * rng.standard_normal(), data.ctrl[0]])
        mujoco.mj_step(model, data, round(0.02 / FINE))
    log = tmp_path / "log.csv"
    head = "time_s,hinge_rad,motor_Nm"
    np.savetxt(log, rows, "%.9g", ",", header=head, comments="")

    def said(step):
        (tmp_path / "swing.xml").write_text(SWING.format(step=step))
        look = new_machine(tmp_path / "swing.xml", [log], tmp_path / f"{step}.toml").draft.look
        return [text for text in look if "timestep" in text]

    assert any(text.startswith("the model's step of 0.02 s puts hinge") for text in said(0.02))
    assert not said(0.0001)
