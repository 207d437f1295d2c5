"""ves-twin new: a file is drafted once, never over another, and what does not fit is one line."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

from ves_twin.cli.main import main
from ves_twin.machines.mjcf.rig.machine import Rig

CART = """
<mujoco model="cart">
  <option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="cart">
    <joint name="rail" type="slide" axis="1 0 0" damping="4"/>
    <geom type="box" size="0.1 0.08 0.04" mass="3" contype="0" conaffinity="0"/>
  </body></worldbody>
  <actuator><motor name="drive" joint="rail"/></actuator>
</mujoco>
"""

URDF = """
<robot name="arm">
  <link name="base"><inertial><mass value="5"/><origin xyz="0 0 0"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="link">
    <visual><geometry><mesh filename="package://arm/link.stl"/></geometry></visual>
    <inertial><mass value="1"/><origin xyz="0 0 -0.2"/>
      <inertia ixx="0.0" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="link"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="3"/></joint>
</robot>
"""


def log_of(seconds: float = 6.0, seed: int = 1, friction: float = 2.0) -> str:
    """A cart pushed to and fro, with dry friction that its model lacks."""
    spec = mujoco.MjSpec.from_string(CART)
    spec.joint("rail").frictionloss = friction
    model, rng = spec.compile(), np.random.default_rng(seed)
    data, phase = mujoco.MjData(model), rng.uniform(0.0, 6.28, 3)
    lines = ["t [s];F [N];x [mm]"]
    for k in range(int(200 * seconds)):
        force = 8.0 * np.sum(np.sin(2.0 * np.pi * np.array([0.4, 0.9, 1.3]) * k / 200.0 + phase))
        x = 1000.0 * data.qpos[0] + 0.1 * rng.standard_normal()
        lines.append(f"{k / 200:.3f};{force:.6f};{x:.6f}")
        data.ctrl[0] = force
        for _ in range(5):
            mujoco.mj_step(model, data)
    return "\n".join(lines)


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with a model and a log."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cart.xml").write_text(CART)
    (tmp_path / "log.csv").write_text(log_of())
    return tmp_path


def test_a_draft_is_written_told_and_read_by_the_other_commands(bench, capsys):
    assert main(["new", "cart.xml", "log.csv"]) == 0
    out = capsys.readouterr().out
    assert "drafted cart.toml" in out
    assert "ves-twin diagnose log.csv --plant cart.toml" in out  # too short to be parted
    assert main(["compare", "log.csv", "--plant", "cart.toml", "--out", "compared"]) == 0


def test_every_guess_comes_as_json_with_its_reason(bench, capsys):
    assert main(["new", "cart.xml", "log.csv", "--json", "--out", "deep/my.toml"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert Path(content["plant"]) == Path("deep/my.toml")
    guesses = {guess["column"]: guess for guess in content["guesses"]}
    assert "position of joint rail" in guesses["x [mm]"]["taken_for"]
    assert "unit mm" in guesses["x [mm]"]["why"]
    assert Rig.load("deep/my.toml").description.drive.actuators == {"drive": "drive.effort"}


def test_a_draft_is_never_written_over_a_file(bench, capsys):
    (bench / "cart.toml").write_text("mine")
    assert main(["new", "cart.xml", "log.csv"]) == 2
    assert "a draft is never written over it" in capsys.readouterr().err
    assert (bench / "cart.toml").read_text() == "mine"


def test_a_urdf_becomes_a_model_beside_the_draft_and_says_what_it_lacked(bench, capsys):
    (bench / "arm.urdf").write_text(URDF)
    time = 0.01 * np.arange(500)
    q = 0.5 * np.sin(3.0 * time) + 0.3 * np.sin(7.1 * time)
    speed = np.gradient(q, 0.01)
    # inertia about the joint 0.02 + 1 * 0.2^2, weight 1 * 9.81 * 0.2
    torque = 0.06 * np.gradient(speed, 0.01) + 1.962 * np.sin(q)
    rows = np.column_stack([time, q, torque])
    np.savetxt("arm.csv", rows, "%.8g", ",", header="t,q1,tau1", comments="")
    assert main(["new", "arm.urdf", "arm.csv"]) == 0
    out = capsys.readouterr().out
    assert "1 mesh files are missing (link.stl): shapes are left out" in out
    assert "inertia of link is zero" in out
    assert "a motor was added at each of 1 joints" in out
    assert Rig.load("arm.toml").model.nu == 1
    (bench / "arm.toml").unlink()
    assert main(["new", "arm.urdf", "arm.csv"]) == 2  # the model beside it is there
    assert "arm.xml is there" in capsys.readouterr().err
    assert not (bench / "arm.toml").exists()


@pytest.mark.parametrize(
    ("model", "log", "words"),
    [
        (CART.replace("<actuator>", "<!--").replace("</actuator>", "-->"), None, "a model without"),
        (CART.replace('name="rail"', "").replace(' joint="rail"', ' site="s"'), None, "cart.xml"),
        ("<mujoco><worldbody/></mujoco>", None, "no named joint"),
        ("<mujoco", None, "an MJCF or URDF file"),
        ("<robot><link name='a'/></robot>", None, "no named joint"),
        (CART, "t;a;b\n" + "\n".join(f"{k};{k % 3};{k % 5}" for k in range(99)), "does not fit"),
        (CART, "t;x [mm]\n" + "\n".join(f"{k};{k % 3}" for k in range(99)), "an effort of drive"),
        (CART, "t;F [N]\n" + "\n".join(f"{k};{k % 3}" for k in range(99)), "of rail"),
        (CART, "t;F [N];x [mm]\n" + "\n".join(f"{k};1;2" for k in range(99)), "constant: F [N]"),
        (CART, "t;x\n1;2\n2;3\n", "2 rows"),
        (CART, "x\n" + "\n".join(str(k % 7) for k in range(99)), "1 columns of numbers"),
        (CART, "x;F\n" + "\n".join(f"{k % 7};{k % 3}" for k in range(99)), "--rate"),
        (CART, "", "0 bytes"),
    ],
)
def test_what_does_not_fit_is_one_line_and_leaves_no_file(bench, capsys, model, log, words):
    (bench / "cart.xml").write_text(model)
    if log is not None:
        (bench / "log.csv").write_text(log)
    assert main(["new", "cart.xml", "log.csv"]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
    assert sorted(p.name for p in bench.iterdir()) == ["cart.xml", "log.csv"]


@pytest.mark.parametrize("words", [["new", "no.xml", "log.csv"], ["new", "cart.xml", "no.csv"]])
def test_a_file_that_is_missing_is_named(bench, capsys, words):
    assert main(words) == 2
    assert "no." in capsys.readouterr().err


def test_a_second_log_must_have_the_columns_of_the_first(bench, capsys):
    (bench / "other.csv").write_text(log_of().replace("x [mm]", "y [mm]"))
    assert main(["new", "cart.xml", "log.csv", "other.csv"]) == 2
    assert "'x [mm]'; did you mean 'y [mm]'?" in capsys.readouterr().err


@pytest.mark.slow
def test_a_diagnosis_drafts_in_passing_and_names_the_friction(bench, capsys):
    (bench / "check.csv").write_text(log_of(seed=2))
    words = ["diagnose", "log.csv", "--held-out", "check.csv", "--model", "cart.xml"]
    assert main([*words, "--out", "out"]) == 0
    captured = capsys.readouterr()
    assert "drafted out/cart.toml" in captured.err
    verdict = json.loads((bench / "out" / "verdict.json").read_text())
    (cause,) = verdict["causes"]
    assert (cause["effect"], cause["target"]) == ("coulomb_friction", "rail")
    level = cause["parameters"]["level"]
    assert level["low"] <= 2.0 <= level["high"] or abs(level["value"] - 2.0) < 0.05
    # the draft is a machine like any other, and what was extended stands on it
    assert Rig.load("out/plant.toml").model.dof_frictionloss[0] == pytest.approx(level["value"])
    assert main([*words, "--out", "out"]) == 2
    assert "a draft is never written over it" in capsys.readouterr().err


def test_a_diagnosis_of_a_log_that_does_not_fit_drafts_nothing(bench, capsys):
    (bench / "log.csv").write_text(log_of().replace("F [N]", "G [T]"))
    assert main(["diagnose", "log.csv", "--model", "cart.xml", "--out", "out"]) == 2
    assert "does not fit the model" in capsys.readouterr().err
    assert not (bench / "out").exists()


def test_a_model_and_a_plant_are_not_both_asked_for(bench, capsys):
    assert main(["diagnose", "log.csv", "--model", "cart.xml", "--plant", "pendulum"]) == 2
    assert "--model" in capsys.readouterr().err


def test_of_a_log_that_is_too_short_the_next_step_is_not_a_command_that_refuses(bench, capsys):
    (bench / "short.csv").write_text(log_of(0.9))
    assert main(["new", "cart.xml", "short.csv", "--out", "short.toml"]) == 0
    told = capsys.readouterr().out
    assert "look      too short for a diagnosis" in told
    assert "next      see to the rows that a diagnosis lacks (look); then ves-twin diagnose" in told
    assert main(["new", "cart.xml", "log.csv", "--out", "long.toml"]) == 0
    assert "see to the rows" not in capsys.readouterr().out
