"""A motor driven by volts: its constant is the model's where that explains more of the motion."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted

MOTOR = """<mujoco><option timestep="0.001" integrator="implicitfast"/>
  <worldbody><body name="rotor">
    <joint name="shaft" axis="0 0 1" damping="0.0085" armature="{armature}" frictionloss="{dry}"/>
    <geom type="cylinder" size="0.01 0.01" mass="0.005"/></body></worldbody>
  <actuator><motor name="drive" joint="shaft" gear="{gear}"/></actuator></mujoco>"""


def logged(tmp_path, armature: float, gear: float = 0.022):
    """Of a motor with six times the inertia that its model has; then the model."""
    truth = mujoco.MjModel.from_xml_string(MOTOR.format(armature=6e-4, dry=0.014, gear=gear))
    data, rows = mujoco.MjData(truth), []
    rng = np.random.default_rng(0)
    for k in range(600):
        volts = 9.0 if k % 300 > 150 else 3.0 * (k % 300 > 50)
        rows.append((0.005 * k, volts, data.qvel[0] + 0.05 * rng.standard_normal()))
        data.ctrl[0] = volts
        mujoco.mj_step(truth, data, 5)
    log, path = tmp_path / "log.csv", tmp_path / "motor.xml"
    np.savetxt(log, rows, "%.6g", ",", header="t_s,voltage_V,shaft_speed_rad_s", comments="")
    path.write_text(MOTOR.format(armature=armature, dry=0.0, gear=0.022))
    return path, log


def test_an_inertia_that_is_wrong_gives_no_constant(tmp_path):
    """0.31 was written, with which the model explained 22 % of a measured motor's speed, not 90."""
    found, rig = drafted(*logged(tmp_path, 1e-4))
    assert rig.description.signals["drive.effort"].scale == 1.0
    assert any(
        "as the model has it: simulated, that explains more" in words for words in found.look
    )
    assert all("is electrical" not in words for words in found.look)
    assert found.explained["shaft.speed"] > 0.8


def test_a_constant_that_a_motor_has_is_kept(tmp_path):
    found, rig = drafted(*logged(tmp_path, 6e-4, gear=0.1))
    assert rig.description.signals["drive.effort"].scale == pytest.approx(0.1 / 0.022, rel=0.2)
    assert any("is electrical" in words for words in found.look)


@pytest.mark.parametrize(("name", "known"), [("voltage_V", 0.01), ("motor_pwm", 0.2)])
def test_what_a_count_of_a_duty_makes_nobody_tells_to_a_hundredth(tmp_path, name, known):
    """A cart's viscous friction was firm by it, where only its ratio to the gain is known."""
    model, log = logged(tmp_path, 6e-4)
    log.write_text(log.read_text().replace("voltage_V", name))
    _, rig = drafted(model, log)
    assert rig.description.tolerances["gain"] == known
