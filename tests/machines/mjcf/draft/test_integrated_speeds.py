"""A speed is enough where no effort hangs on the angle: its integral is fed in as the motion."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted
from pydantic import ValidationError

from ves_twin.cli.main import main
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.machine import SETPOINTS
from ves_twin.machines.mjcf.inputs.excitations import write_inputs
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.column import Column

RPM, DRY, PERIOD, ROWS = np.pi / 30.0, 0.004, 0.01, 1500

ROTOR = """<mujoco><option timestep="0.001" integrator="implicitfast" gravity="0 0 {weight}"/>
  <worldbody><body name="rotor">
    <joint name="shaft" axis="{axis}" damping="1e-4" frictionloss="{dry}"/>
    <inertial pos="{off} 0 0" mass="0.05" diaginertia="1e-4 1e-4 1e-4"/></body></worldbody>
  <actuator><motor name="drive" joint="shaft"/></actuator></mujoco>"""


def turned_by_a_motor(**parts):
    """Speed [rpm] and torque [N m] of a rotor with dry friction that goes both ways."""
    given = {"weight": 0.0, "axis": "0 0 1", "off": 0.0, "dry": DRY} | parts
    model = mujoco.MjModel.from_xml_string(ROTOR.format(**given))
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(4), []
    for k in range(ROWS):
        data.ctrl[0] = 0.02 * np.sin(0.021 * k) + 0.008 * np.sin(0.1 * k + 1.0)
        rows.append((PERIOD * k, data.qvel[0] / RPM + 0.2 * rng.standard_normal(), data.ctrl[0]))
        for _ in range(10):
            mujoco.mj_step(model, data)
    time, speed, torque = np.array(rows).T
    return {"t": time, "speed_rpm": speed, "torque_Nm": torque + 1e-4 * rng.standard_normal(ROWS)}


@pytest.fixture
def rotor(tmp_path):
    path = tmp_path / "rotor.xml"
    path.write_text(ROTOR.format(weight=0.0, axis="0 0 1", off=0.0, dry=0.0))
    return path


def test_a_motor_of_which_speed_and_torque_are_told_is_drafted_by_its_motion(rotor, write):
    found, rig = drafted(rotor, write(turned_by_a_motor()))
    assert found.mode.startswith("motion: every joint has a motion and an effort")
    assert rig.description.drive.joints == {"shaft": "shaft.position"}
    assert list(rig.description.compare) == ["shaft.position", "drive.effort"]
    (guess,) = (one for one in found.guesses if one.column == "speed_rpm")
    assert guess.taken_for == "speed of joint shaft [rpm], integrated, fed in as shaft.position"


def test_its_position_is_the_integral_of_the_speed(rotor, write):
    log = turned_by_a_motor()
    path = write(log)
    rig = drafted(rotor, path)[1]
    angle = read_rig_recording(path, rig)["shaft.position"][:, 0]
    assert angle[0] == 0.0
    steps = 0.5 * PERIOD * RPM * (log["speed_rpm"][1:] + log["speed_rpm"][:-1])
    assert np.diff(angle) == pytest.approx(steps, abs=1e-9)  # printed to nine digits


def test_the_efforts_of_that_motion_are_the_measured_ones_with_the_friction_that_is_there(
    rotor, write
):
    """To a tenth of it where the motor turns: about its turning points the low-pass rounds it."""
    log = turned_by_a_motor()
    path = write(log)
    rig = drafted(rotor, path)[1]
    forward, left = MjcfForward.of(rig), []
    fed = Excitation.of(read_rig_recording(path, rig), forward.drive, "motor")
    for friction in (0.0, DRY):
        values = {"coulomb_friction@shaft:level": friction}
        need = forward.simulate(fed, values)[:, 0]
        rest = (log["torque_Nm"] - need)[50:-50]
        left.append(float(np.std(rest[np.abs(log["speed_rpm"][50:-50]) > 100.0])))
    assert left[1] < 0.1 * DRY < 0.5 * DRY < left[0]


def test_a_dry_friction_is_named_of_speeds_alone(rotor, write, tmp_path, capsys):
    """As a control that is predicted, the same kind of log of a motor took 30 times as long."""
    path = write(turned_by_a_motor())
    drafted(rotor, path)
    plant, out = rotor.with_name("my.toml"), tmp_path / "out"
    command = ["diagnose", str(path), "--plant", str(plant), "--alternate", "5.5"]
    assert main([*command, "--out", str(out)]) == 0
    assert "Coulomb friction at shaft" in capsys.readouterr().out


def test_where_a_weight_hangs_on_the_angle_a_speed_is_not_enough(tmp_path, write):
    path = tmp_path / "arm.xml"
    hung = {"weight": -9.81, "axis": "0 1 0", "off": 0.005}
    path.write_text(ROTOR.format(**hung, dry=0.0))
    found, rig = drafted(path, write(turned_by_a_motor(**hung)))
    assert found.mode.startswith("control: not every position is told")
    assert rig.description.signals["shaft.speed"].of == "speed"


def test_a_speed_too_noisy_to_be_differentiated_is_predicted(rotor, write):
    log = turned_by_a_motor()
    loud = log["speed_rpm"] + 300.0 * np.random.default_rng(0).standard_normal(ROWS)
    found, _ = drafted(rotor, write(log | {"speed_rpm": loud}))
    assert "speed_rpm is too noisy to be differentiated (" in found.mode


def test_set_points_of_a_next_experiment_are_speeds_in_the_unit_of_the_log(rotor, write, tmp_path):
    rig = drafted(rotor, write(turned_by_a_motor()))[1]
    time = PERIOD * np.arange(500)
    angle = np.sin(2.0 * time)[:, None]
    write_inputs(MjcfForward.of(rig), Excitation("next", time, {"shaft.position": angle}), tmp_path)
    read = np.genfromtxt(tmp_path / SETPOINTS, delimiter=",", names=True)
    wanted = 2.0 * np.cos(2.0 * time) / RPM
    assert read["speed_rpm"][1:-1] == pytest.approx(wanted[1:-1], abs=0.01)  # of 19 rpm, by steps


def test_an_integral_has_the_unit_of_a_position():
    column = Column(columns=("n",), unit="rpm", joint="shaft", integrated=True, offset=0.5)
    assert (column.unit, column.scale) == ("rad", to_si("1 rpm", "rad/s", "n"))
    assert column.offset == 0.5
    slid = Column(columns=("v",), unit="mm/s", joint="rail", integrated=True)
    assert (slid.unit, slid.scale) == ("m", pytest.approx(1e-3))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"unit": "rad"}, "expected that of a speed"),
        ({"unit": "rad/s", "of": "speed"}, "the joint whose position it is"),
        ({"unit": "rad/s", "joint": ""}, "the joint whose position it is"),
    ],
)
def test_what_cannot_be_integrated_is_refused(more, told):
    given = {"columns": ("n",), "joint": "shaft", "integrated": True} | more
    with pytest.raises(ValidationError, match=told):
        Column.model_validate(given)
