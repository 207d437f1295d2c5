"""Drafts of a piston: a steady load beside its friction, pressures, two forces at one joint."""

import numpy as np
import pytest
from drafted import drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording

MODEL = """
<mujoco model="piston">
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="rod">
      <joint name="piston" type="slide" axis="1 0 0" damping="20"/>
      <geom type="box" size="0.05 0.02 0.02" mass="0.4"/>
    </body>
  </worldbody>
  <actuator>{}</actuator>
</mujoco>
"""

ONE = '<motor name="load" joint="piston"/>'
TWO = ONE + '<general name="air" joint="piston" gear="-49"/>'


@pytest.fixture
def moved():
    """A stroke out and a shorter one back [s, m], and the friction of 6 N against it."""
    t = 0.01 * np.arange(400)
    x = np.where(t < 2.4, 0.02 * t, 0.048 - 0.012 * (t - 2.4))
    x = np.convolve(np.pad(x, 20, "edge"), np.ones(41) / 41.0, "valid")
    rng = np.random.default_rng(5)
    v = np.gradient(x, t)
    return t, x + 1e-6 * rng.standard_normal(400), 6.0 * np.tanh(v / 1e-3) + 20.0 * v


def model(tmp_path, actuators):
    path = tmp_path / "piston.xml"
    path.write_text(MODEL.format(actuators))
    return path


def test_a_steady_load_beside_friction_turns_no_sign(tmp_path, write, moved):
    """Where a stroke ends elsewhere than it began a constant does work, and tells nothing."""
    t, x, friction = moved
    force = friction - 245.0 + 0.05 * np.random.default_rng(1).standard_normal(400)
    found, rig = drafted(model(tmp_path, ONE), write({"t": t, "x_m": x, "force_N": force}))
    assert not any("wrong sign" in words for words in found.look)
    assert rig.description.signals["load.effort"].scale == 1.0
    turned, rig = drafted(model(tmp_path, ONE), write({"t": t, "x_m": x, "force_N": -force}))
    assert any("force_N has the wrong sign" in words for words in turned.look)
    assert rig.description.signals["load.effort"].scale == -1.0


def test_two_forces_at_one_joint_are_fed_in_together(tmp_path, write, moved):
    t, x, friction = moved
    bar = 5.0 + 0.01 * np.random.default_rng(1).standard_normal(400)
    log = write({"t": t, "x_m": x, "force_N": friction + 49.0 * bar, "pressure_bar": bar})
    found, rig = drafted(model(tmp_path, TWO), log)
    assert found.mode.startswith("control: of what pushes piston a motion tells the sum alone")
    assert rig.description.drive.actuators == {"load": "load.effort", "air": "air.effort"}
    recording = read_rig_recording(log, rig)
    forward = MjcfForward.of(rig)
    path = forward.simulate(Excitation.of(recording, forward.drive), {})[:, 0]
    assert np.ptp(recording["air.effort"]) < 1.0  # bar, as the model's gear has it
    assert np.all(np.isfinite(path))


def test_a_pressure_is_what_drives_a_piston_by_an_area_that_is_asked(tmp_path, write, moved):
    t, x, friction = moved
    log = write({"t": t, "x_m": x, "pressure_bar": friction / 49.0})
    found, _ = drafted(model(tmp_path, ONE), log)
    (words,) = [words for words in found.look if "is a pressure" in words]
    assert words.startswith("pressure_bar is a pressure: ")
    assert words.endswith("put the piston's area there")


def test_a_barometer_beside_a_hinge_is_no_torque(swing, write):
    path, columns = swing
    weather = 1013.0 + 0.1 * np.random.default_rng(2).standard_normal(len(columns["t"]))
    log = {"t": columns["t"], "q": columns["q"], "tau": columns["tau"], "pressure_bar": weather}
    found, rig = drafted(path, write(log))
    assert "pressure_bar" in found.left
    assert rig.description.signals["drive.effort"].columns == ("tau",)
    with pytest.raises(InvalidInputError, match="an effort of drive"):
        drafted(path, write({name: log[name] for name in ("t", "q", "pressure_bar")}))
