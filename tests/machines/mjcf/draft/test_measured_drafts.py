"""Drafts of measured machines: every column found, the public constants near, a verdict at the end.

Rules are of names, units and physics in general; that of the seven-axis arm came last, unseen.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import pytest

from ves_twin.core.resources import resource_folder
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.load import open_machine
from ves_twin.machines.mjcf.draft.draft import Draft, draft
from ves_twin.machines.new_machine import new_machine

sys.path.append(str(Path(__file__).parents[4] / "benchmarks"))
from real.damper import MODEL as DAMPER

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(1800)]

QUICK = Settings(nulls=40)
"""Thresholds matter little where causes stand out by thousands of chi^2."""

SILVER = """
<mujoco model="silver"><option timestep="0.0004" integrator="implicitfast" gravity="0 0 0"/>
<worldbody><body name="mass">
<joint name="y" type="slide" axis="1 0 0" damping="0.0002" stiffness="1"/>
<geom size="0.1" mass="5e-6"/></body></worldbody>
<actuator><motor name="u" joint="y"/></actuator></mujoco>
"""

PENDULUM = """
<mujoco model="double"><option timestep="0.001" integrator="implicitfast"/>
<default><geom contype="0" conaffinity="0"/></default>
<worldbody><body name="upper">
<joint name="shoulder" axis="0 1 0" damping="0.001" armature="0.0027"/>
<inertial pos="0 0 -0.3" mass="0.559" diaginertia="0.0031 0.0031 0.0001"/>
<body name="lower" pos="0 0 -0.3">
<joint name="elbow" axis="0 1 0" damping="0.001" armature="0.0027"/>
<inertial pos="0 0 -0.184" mass="0.604" diaginertia="0.0035 0.0035 0.0001"/></body></body>
</worldbody>
<actuator><motor name="m1" joint="shoulder"/><motor name="m2" joint="elbow"/></actuator></mujoco>
"""


def drafted(folder: Path, model: str | Path, log: Path, rate: float | None = None) -> Draft:
    path = model if isinstance(model, Path) else folder / "model.xml"
    if isinstance(model, str):
        path.write_text(model)
    return draft(path, [log], folder / "my.toml", rate)


def places(found: Draft) -> dict[str, str]:
    """Column -> signal."""
    signals = tomllib.loads(found.text)["signals"]
    return {signal["columns"][0]: name for name, signal in signals.items()}


def test_every_column_of_the_arm_is_found_in_a_file_of_less_than_forty_lines(tmp_path, data_folder):
    found = drafted(tmp_path, data_folder / "tx40" / "tx40.urdf", data_folder / "tx40" / "tx40.csv")
    wanted = {f"q{i}": f"joint_{i}.position" for i in range(1, 7)}
    assert places(found) == wanted | {f"tau{i}": f"motor_joint_{i}.effort" for i in range(1, 7)}
    assert len(found.text.splitlines()) < 40
    assert found.mode.startswith("motion")
    assert not [words for words in found.look if "sign" in words or "swapped" in words]


def test_the_damper_s_force_is_not_turned_though_its_mass_tells_nothing(tmp_path, data_folder):
    for name in ("h6", "h2", "KocaeliMCE"):
        found = drafted(tmp_path, DAMPER, data_folder / "damper" / f"{name}.csv")
        assert places(found) == {"x": "stroke.position", "F": "machine.effort"}
        assert "scale" not in tomllib.loads(found.text)["signals"]["machine.effort"]


def test_the_axis_is_in_volts_and_its_constant_fits_within_a_tenth(tmp_path, data_folder):
    model = resource_folder("models/machines/emps") / "emps.xml"
    found = drafted(tmp_path, model, data_folder / "emps" / "emps_train.csv")
    signals = tomllib.loads(found.text)["signals"]
    assert signals["motor.effort"]["scale"] == pytest.approx(35.15065188, rel=0.1)
    assert found.left == {"q_ref_m": "says what was asked for"}


def test_the_double_pendulum_has_its_measured_torques_before_commands(tmp_path, data_folder):
    log = data_folder / "dfki_double_pendulum" / "A0_traj00.csv"
    assert places(drafted(tmp_path, PENDULUM, log)) == {
        "q1_rad": "shoulder.position",
        "q2_rad": "elbow.position",
        "tau_meas1_Nm": "m1.effort",
        "tau_meas2_Nm": "m2.effort",
    }


def test_the_silver_box_has_its_motion_told_from_its_effort_by_shape(tmp_path, data_folder):
    found = drafted(tmp_path, SILVER, data_folder / "silverbox" / "SNLS80mV.csv", 610.35)
    assert places(found) == {"V2": "y.position", "V1": "u.effort"}


def test_a_second_arm_of_seven_axes_is_found_without_a_column_of_time(tmp_path, data_folder):
    folder = data_folder / "xmate7p_7axis"
    found = drafted(tmp_path, folder / "XM7p.urdf", folder / "traj1_50Hz.csv", 49.975)
    wanted = {f"q{i}_rad": f"joint{i}.position" for i in range(1, 8)}
    assert places(found) == wanted | {f"tau{i}_Nm": f"motor_joint{i}.effort" for i in range(1, 8)}
    assert found.explained["tau2_Nm"] > 0.9
    assert not [words for words in found.look if "sign" in words or "swapped" in words]


def test_the_axis_goes_to_the_published_frictions_with_two_lines_by_hand(tmp_path, data_folder):
    model = resource_folder("models/machines/emps") / "emps.xml"
    log = data_folder / "emps" / "emps_train.csv"
    path = new_machine(model, [log], tmp_path / "emps.toml").path
    lines = path.read_text().splitlines()
    for i, line in enumerate(lines):
        if line.startswith("tolerances"):
            lines[i] = 'tolerances = { mass = "10 %", gain = "1 %" }'
        if line.startswith('"motor.effort"'):
            lines[i] = line.replace(line.split("scale = ")[1].split(",")[0], "35.15065188")
    path.write_text("\n".join(lines))
    machine = open_machine(str(path))
    verdict = diagnose([machine.read(str(log))], machine, alternate=6.24, settings=QUICK).verdict
    found = {f"{c.effect}@{c.target}": c for c in verdict.causes}
    assert {"viscous_friction@axis", "coulomb_friction@axis"} <= found.keys()
    level = found["coulomb_friction@axis"].parameters["level"].value
    assert level == pytest.approx(20.39, rel=0.05)
