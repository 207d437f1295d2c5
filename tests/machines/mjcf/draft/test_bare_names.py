"""Columns that bear the model's own names, or those of pulses, and no unit."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted


def test_columns_called_as_joints_and_actuators_are_those_without_any_unit(tmp_path, write):
    """A twin rotor whose columns bore the model's own names was refused: none of them matched."""
    path = tmp_path / "rotor.xml"
    path.write_text(
        '<mujoco><worldbody><body><joint name="yaw" axis="0 0 1" damping="0.01"/>'
        '<inertial pos="0 0 0" mass="0.3" diaginertia="0.01 0.01 0.02"/><body>'
        '<joint name="pitch" axis="0 -1 0" damping="0.02"/>'
        '<inertial pos="0 0 -0.03" mass="0.6" diaginertia="0.04 0.04 0.04"/></body></body>'
        '</worldbody><actuator><motor name="main_rotor" joint="pitch"/>'
        '<motor name="tail_rotor" joint="yaw"/></actuator></mujoco>'
    )
    t = 0.02 * np.arange(800)
    log = {"t": t, "main_rotor": np.sin(2.0 * t), "tail_rotor": np.cos(3.0 * t)}
    log |= {"pitch": 0.2 * np.sin(2.0 * t), "yaw": 0.3 * np.cos(3.0 * t)}
    found, _ = drafted(path, write(log))
    taken = {guess.column: guess.taken_for.split(" [")[0].lstrip("-") for guess in found.guesses}
    assert taken == {
        "yaw": "position of joint yaw",
        "pitch": "position of joint pitch",
        "main_rotor": "actuator main_rotor",
        "tail_rotor": "actuator tail_rotor",
    }


@pytest.mark.parametrize("name", ["pitch_pwm_us", "pulse_us", "throttle"])
def test_pulses_and_throttles_are_commands_of_a_motor(swing, write, name):
    path, columns = swing
    pulse = 1500.0 + 100.0 * columns["tau"]
    _, rig = drafted(path, write({"t": columns["t"], name: pulse, "q": columns["q"]}))
    assert rig.description.signals["drive.effort"].columns == (name,)
