"""Set-points of servos and the positions that follow them: sign, unit, swap, another zero."""

from __future__ import annotations

import tomllib

import mujoco
import numpy as np
import pytest
from drafted import drafted

SERVO = """
<mujoco model="servo">
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody><body name="arm">
    <joint name="shoulder" axis="0 1 0" armature="0.005"/>
    <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" mass="0.2"/>
  </body></worldbody>
  <actuator><position name="drive" joint="shoulder" kp="8" kv="0.4"/></actuator>
</mujoco>
"""
DEGREES = 180.0 / np.pi


@pytest.fixture
def log(tmp_path):
    """The model's file, and t, target, angle of it [s, rad]; the arm's weight pulls one way."""
    path = tmp_path / "servo.xml"
    path.write_text(SERVO)
    model, rng = mujoco.MjModel.from_xml_string(SERVO), np.random.default_rng(4)
    data, rows = mujoco.MjData(model), np.zeros((500, 3))
    for k in range(len(rows)):
        target = 0.7 * np.sin(0.03 * k) + 0.4 * np.sin(0.071 * k + 1.0)
        rows[k] = 0.02 * k, target, data.qpos[0] + 5e-4 * rng.standard_normal()
        data.ctrl[0] = target
        for _ in range(20):
            mujoco.mj_step(model, data)
    return path, dict(zip(("t", "target_rad", "angle_rad"), rows.T, strict=True))


def said(log, write, **new):
    """What a draft of other columns says, and the share that the model explains then."""
    path, columns = log
    found, rig = drafted(path, write({**columns, **new}))
    (share,) = found.explained.values()
    return " ".join(found.look), share, rig


def test_of_a_log_that_is_right_nothing_is_changed(log, write):
    """The joint was taken for one that nothing drives, and a quarter turn was added to its angle."""
    words, share, _ = said(log, write)
    assert "angle_rad" not in words
    assert "target_rad" not in words
    assert share > 0.99


@pytest.mark.parametrize("turned", ["angle_rad", "target_rad"])
def test_what_counts_the_other_way_is_turned_as_gravity_says(log, write, turned):
    words, share, _ = said(log, write, **{turned: -log[1][turned]})
    assert f"angle_rad moves against its set-point target_rad: {turned} is turned" in words
    assert share > 0.99


def test_a_position_that_comes_before_its_set_point_is_that_set_point(log, write):
    swapped = {"target_rad": log[1]["angle_rad"], "angle_rad": log[1]["target_rad"]}
    words, share, _ = said(log, write, **swapped)
    assert "before its set-point target_rad: taken the other way round" in words
    assert share > 0.99


def test_degrees_that_are_named_radians_are_told_by_their_numbers(log, write):
    both = {name: DEGREES * log[1][name] for name in ("target_rad", "angle_rad")}
    words, share, _ = said(log, write, **both)
    assert "target_rad, angle_rad: named in rad, the numbers fit the model as deg" in words
    assert share > 0.99


def test_one_of_both_in_degrees_is_told_where_its_unit_is_a_guess(log, write):
    path, columns = log
    named = {"t": columns["t"], "target": columns["target_rad"]}
    found, _ = drafted(path, write(named | {"angle": DEGREES * columns["angle_rad"]}))
    assert "angle: numbers fit the model as deg, not as rad" in " ".join(found.look)
    assert min(found.explained.values()) > 0.99


def test_counts_are_told_with_how_many_there_are_to_a_unit_of_the_set_point(log, write):
    words, _, _ = said(log, write, angle_rad=np.round(652.0 * log[1]["angle_rad"]))
    assert "times its set-point target_rad: another unit, or a gear?" in words


def test_the_typical_effort_of_a_servo_is_its_limit(log, write):
    """By its weight alone a friction of what it drives was out of the range of every cause."""
    path, columns = log
    limited = SERVO.replace('kv="0.4"', 'kv="0.4" forcerange="-2.5 2.5"')
    path.write_text(limited)
    found, _ = drafted(path, write(columns))
    assert tomllib.loads(found.text)["typical"]["joint"]["shoulder"]["effort"] == 2.5


def test_loops_inside_a_servo_are_drafted_as_hardly_known(log, write):
    path, columns = log
    found, rig = drafted(path, write(columns))
    told = tomllib.loads(found.text)["tolerances"]
    assert (told["kp"], told["kv"]) == ("20 %", "20 %")
    kinds = {entry.effect.kind: entry for entry in rig.entries}
    assert kinds["servo_stiffness"].magnitudes[0].sd == pytest.approx(
        0.2 * kinds["servo_stiffness"].nominal[0]
    )
    assert "actuator_gain" not in kinds


def test_another_zero_is_written_in_the_unit_of_its_column(swing, write):
    """A quarter turn was written as -1.57 beside `unit = "deg"`."""
    path, columns = swing
    q = DEGREES * (columns["q"] + np.pi)
    found, rig = drafted(path, write({"t": columns["t"], "tau": columns["tau"], "q_deg": q}))
    (signal,) = (s for s in tomllib.loads(found.text)["signals"].values() if s.get("joint"))
    assert signal["unit"] == "deg"
    assert abs(signal["offset"]) == pytest.approx(180.0)
    assert abs(rig.description.signals["joint.position"].offset) == pytest.approx(np.pi)
