"""A model without actuators that is let go, and a motor of which nothing but speed is told."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted, scales

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import verdict_on
from ves_twin.machines.machine import Machine
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.machine import Rig

DRY, PERIOD, STEPS = 0.004, 0.02, 20

PENDULUM = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body name="rod"><joint name="swing" axis="0 1 0" damping="0.002"{friction}/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.01" mass="0.3"/></body></worldbody>
</mujoco>
"""

ROTOR = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body name="rotor"><joint name="rotor" axis="0 0 1" damping="0.0004"/>
    <geom type="cylinder" size="0.04 0.02" density="1100"/></body></worldbody>
  <actuator><motor name="arm_motor" joint="rotor"/></actuator>
</mujoco>
"""

CONSTANT = 0.005
"""Torque for a volt of the rotor's motor [N m/V]."""


HELD = 0.04
"""A voltage is held from row to row and a speed measured at its begin: half a row of 20 ms against
the rotor's 1.1 s and the low-pass, 2.4 % here."""


def swung(angle: float, seed: int) -> dict[str, np.ndarray]:
    """Time and angle of the pendulum with dry friction, let go at an angle [rad]."""
    friction = f' frictionloss="{DRY}"'
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(friction=friction))
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    data.qpos[0], rows = angle, np.zeros((200, 2))
    for k in range(len(rows)):
        rows[k] = PERIOD * k, data.qpos[0] + 1e-3 * rng.standard_normal()
        mujoco.mj_step(model, data, STEPS)
    return {"time_s": rows[:, 0], "swing_deg": np.degrees(rows[:, 1])}


def spun() -> dict[str, np.ndarray]:
    """Time, voltage and speed of the rotor."""
    model, rng = mujoco.MjModel.from_xml_string(ROTOR), np.random.default_rng(3)
    data, rows = mujoco.MjData(model), np.zeros((1500, 3))
    for k in range(len(rows)):
        volts = 3.0 * np.sin(0.05 * k) + 2.0 * np.sin(0.013 * k + 1.0)
        rows[k] = PERIOD * k, volts, data.qvel[0] + 0.01 * rng.standard_normal()
        data.ctrl[0] = CONSTANT * volts
        mujoco.mj_step(model, data, STEPS)
    return dict(zip(("t", "Voltage_q", "speed_rad_s"), rows.T, strict=True))


@pytest.fixture
def pendulum(tmp_path):
    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM.format(friction=""))
    return path


def test_a_pendulum_that_is_let_go_is_drafted_and_its_friction_found(pendulum, write):
    found, rig = drafted(pendulum, write(swung(1.2, 1)))
    assert "it is let go, and nothing is fed in" in found.mode
    assert not rig.description.drive.actuators
    assert not rig.description.drive.imposed
    path = pendulum.with_name("my.toml")
    text, every = path.read_text(), '[{ kind = "*", on = ["*"] }]'
    kinds = ("coulomb_friction", "viscous_friction", "joint_spring")  # MuJoCo has them all
    few = ", ".join(f'{{ kind = "{kind}", on = ["swing"] }}' for kind in kinds)
    path.write_text(text.replace(every, f"[{few}]"))
    machine = Machine.load(str(path))
    one, two = (
        read_rig_recording(write(swung(angle, seed), f"{seed}.csv"), rig)
        for angle, seed in ((1.2, 1), (0.9, 2))
    )
    verdict = verdict_on([one], machine, held_out=[two], settings=Settings(nulls=20))
    (cause,) = verdict.causes
    assert (cause.effect, cause.target) == ("coulomb_friction", "swing")
    (size,) = cause.parameters.values()
    assert size.low <= DRY <= size.high
    assert size.value == pytest.approx(DRY, rel=0.1)  # damping, known to 20 %, trades with it


def test_compare_says_that_nothing_is_fed_in(pendulum, write, capsys):
    log = write(swung(1.2, 1))
    drafted(pendulum, log)
    plant, out = pendulum.with_name("my.toml"), pendulum.with_name("out")
    main(["compare", str(log), "--plant", str(plant), "--out", str(out)])
    assert "Fed in: nothing: the model is let go" in capsys.readouterr().out


def test_nothing_fed_into_a_driven_model_is_refused(tmp_path, write):
    path = tmp_path / "rotor.xml"
    path.write_text(ROTOR)
    _, rig = drafted(path, write(spun()))
    content = tmp_path.joinpath("my.toml").read_text()
    bare = content.replace(', actuator = "arm_motor"', "")
    assert bare != content
    assert rig.description.drive.actuators
    tmp_path.joinpath("my.toml").write_text(bare)
    with pytest.raises(InvalidInputError, match="none only of a model without actuators"):
        _ = Rig.load(str(tmp_path / "my.toml")).model


def test_a_motor_bench_with_speed_alone_tells_the_motors_constant(tmp_path, write):
    path = tmp_path / "rotor.xml"
    path.write_text(ROTOR)
    found, rig = drafted(path, write(spun()))
    assert scales(rig)["arm_motor.effort"] == pytest.approx(CONSTANT, rel=HELD)
    assert not any("not checked" in words for words in found.look)
    assert min(found.explained.values()) > 0.98


@pytest.mark.parametrize("name", ["iq", "isq", "i_q", "current_q", "Iq_A"])
def test_a_current_across_the_field_is_a_current(tmp_path, write, name):
    path, log = tmp_path / "rotor.xml", spun()
    path.write_text(ROTOR)
    log[name] = log.pop("Voltage_q")
    found, rig = drafted(path, write(log))
    assert scales(rig)["arm_motor.effort"] == pytest.approx(CONSTANT, rel=HELD)
    assert any(f"{name} is electrical" in words for words in found.look)


@pytest.mark.parametrize("name", ["Vm", "duty"])
def test_a_motor_s_voltage_and_its_duty_are_commands(tmp_path, write, name):
    path, log = tmp_path / "rotor.xml", spun()
    path.write_text(ROTOR)
    log[name] = log.pop("Voltage_q")
    _, rig = drafted(path, write(log))
    assert rig.description.signals["arm_motor.effort"].columns == (name,)


def test_whole_numbers_of_many_turns_are_asked_for_as_counts(tmp_path, write):
    path, log = tmp_path / "rotor.xml", spun()
    path.write_text(ROTOR)
    angle = np.cumsum(log.pop("speed_rad_s")) * PERIOD
    log["encoder"] = np.round(angle * 4096.0 / (2.0 * np.pi))
    found, _ = drafted(path, write(log))
    assert any("encoder has whole numbers alone" in words for words in found.look)
    log["encoder"] = angle
    assert not any("whole numbers" in words for words in drafted(path, write(log))[0].look)
