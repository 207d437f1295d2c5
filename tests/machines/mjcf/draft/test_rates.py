"""What speeds, and efforts that are none, tell of the columns beside them."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted, scales


@pytest.mark.parametrize(("factor", "unit"), [(57.29578, "deg/s"), (9.549297, "rpm")])
def test_a_speed_in_another_unit_than_its_name_says_is_converted(swing, write, factor, unit):
    path, columns = swing
    log = {{"dq": "dq_rad_s"}.get(n, n): v for n, v in columns.items()}
    log["dq_rad_s"] = factor * log["dq_rad_s"]
    found, rig = drafted(path, write(log))
    assert any(f"dq_rad_s: numbers fit q as {unit}, not as rad/s" in w for w in found.look)
    assert scales(rig)["joint.speed"] == pytest.approx(1.0 / factor, rel=1e-4)


@pytest.mark.parametrize("speeds", [True, False])
def test_degrees_that_are_named_in_rad_are_told_though_a_motor_constant_is_fitted(
    arm, columns, write, speeds
):
    kept = {n: v for n, v in columns.items() if speeds or not n.startswith("dq")}
    log = {{"q1": "q1_rad", "tau1": "u1_V"}.get(n, n): v for n, v in kept.items()}
    found, rig = drafted(arm, write(log | {"q1_rad": np.degrees(log["q1_rad"])}))
    assert any("q1_rad: named in rad, the numbers fit the model as deg" in w for w in found.look)
    assert scales(rig)["turn.position"] == pytest.approx(np.pi / 180.0)


@pytest.mark.parametrize(
    ("name", "factor"),
    [("", 57.29578), ("", 0.1591549), ("_rad", 57.29578), ("_deg", 1.0)],
)
def test_all_angles_in_another_unit_are_told_though_a_wrist_has_friction_alone(
    arm, columns, write, name, factor
):
    """One torque that no unit explains must not hold back what all the others say."""
    log = {n + name * (n in "q1 q2 q3"): v for n, v in columns.items() if not n.startswith("dq")}
    for n in ("q1", "q2", "q3"):
        log[n + name] = factor * columns[n]
    log["tau3"] = 9.0 * np.tanh(columns["dq3"] / 0.02)
    found, rig = drafted(arm, write(log))
    assert any(w.startswith(f"q1{name}, q2{name}, q3{name}: ") for w in found.look)
    joints = ("turn.position", "lift.position", "bend.position")
    assert [scales(rig)[j] for j in joints] == pytest.approx([1.0 / factor] * 3, rel=1e-4)


def test_torques_in_thousandths_are_told_by_those_that_friction_does_not_hide(arm, columns, write):
    log = {n: 1e3 * v if n.startswith("tau") else v for n, v in columns.items()}
    log["tau3"] = 9e3 * np.tanh(columns["dq3"] / 0.02)
    found, rig = drafted(arm, write(log))
    assert any("tau1, tau2, tau3: numbers fit the model as mN*m" in w for w in found.look)
    assert [scales(rig)[f"m{k}.effort"] for k in (1, 2, 3)] == pytest.approx([1e-3] * 3)


def test_torques_of_which_one_is_a_thousand_times_off_keep_their_unit(arm, columns, write):
    found, rig = drafted(arm, write(changed(columns, tau2=1e3 * columns["tau2"])))
    assert any("tau2 is 1e+03 times what the model needs" in w for w in found.look)
    assert scales(rig)["m2.effort"] == 1.0


@pytest.mark.parametrize(("factor", "told"), [(1.0, False), (1.35, True)])
def test_torques_that_are_all_a_part_more_than_the_models_are_told(
    arm, columns, write, factor, told
):
    log = {n: factor * v if n.startswith("tau") else v for n, v in columns.items()}
    found, rig = drafted(arm, write(log))
    said = [words for words in found.look if words.startswith("beside friction the log has")]
    assert len(said) == told
    assert all("1.35 times (tau1), 1.35 times (tau2)" in words for words in said)
    assert [scales(rig)[f"m{k}.effort"] for k in (1, 2, 3)] == [1.0, 1.0, 1.0]


def test_a_position_and_its_speed_that_are_swapped_are_asked_after(swing, write):
    path, columns = swing
    found, _ = drafted(path, write(changed(columns, q=columns["dq"], dq=columns["q"])))
    assert any("q is the rate of dq: are they swapped?" in words for words in found.look)


def test_of_columns_without_names_a_speed_is_no_effort(swing, write):
    path, _ = swing
    model, rng = mujoco.MjModel.from_xml_path(str(path)), np.random.default_rng(5)
    data, rows, torque = mujoco.MjData(model), np.zeros((1500, 4)), 0.0
    for k in range(len(rows)):  # steps: which of both is the cause is clear
        torque = rng.uniform(-1.0, 1.0) if k % 40 == 0 else torque
        rows[k] = 0.01 * k, torque, data.qpos[0], data.qvel[0]
        data.ctrl[0] = torque
        mujoco.mj_step(model, data, 5)
    rows[:, 2:] += np.array([1e-4, 0.01]) * rng.standard_normal((1500, 2))
    named = dict(zip(("t", "column_2", "column_3", "column_4"), rows.T, strict=True))
    found, rig = drafted(path, write(named))
    assert found.left["column_4"] == "is the rate of column_3"
    taken = {n: c.columns for n, c in rig.description.signals.items()}
    assert taken == {"joint.position": ("column_3",), "drive.effort": ("column_2",)}


def test_a_speed_before_a_gear_goes_with_its_position(tmp_path, swing, write):
    path, columns = swing
    path.write_text(path.read_text().replace('joint="joint"/>', 'joint="joint" gear="6"/>'))
    log = {"tau": columns["tau"] / 6.0, "q": 6.0 * columns["q"], "dq": 6.0 * columns["dq"]}
    found, _ = drafted(path, write({"t": columns["t"], **log}))
    assert any("q: numbers fit the model as those of the motor" in words for words in found.look)
    assert any("dq: numbers fit q as those of the motor, too" in words for words in found.look)


def test_speeds_go_with_positions_that_are_swapped(arm, columns, write):
    pairs = {"q2": "q3", "q3": "q2", "dq2": "dq3", "dq3": "dq2"}
    found, _ = drafted(arm, write(changed(columns, **{n: columns[o] for n, o in pairs.items()})))
    assert any("q2 and q3 look swapped, their speeds too" in words for words in found.look)
    assert not any("follow" in words or "the rate of" in words for words in found.look)


def test_a_clock_that_is_off_is_asked_after_by_all_speeds(arm, columns, write):
    found, _ = drafted(arm, write(columns | {"t": 2.0 * columns["t"]}))
    assert "all speeds are 2 times the rate of their positions: is the clock right?" in found.look


def test_an_effort_that_is_the_rate_of_its_position_is_told(swing, write):
    path, columns = swing
    found, _ = drafted(path, write(changed(columns, tau=columns["dq"], dq=columns["tau"])))
    assert "tau is the rate of q: are effort and speed swapped?" in found.look


@pytest.mark.parametrize(
    ("turn", "name"),
    [(np.pi, "half a turn"), (0.5 * np.pi, "a quarter turn"), (-0.5 * np.pi, "minus a quarter")],
)
def test_an_angle_with_another_zero_than_the_model_s_is_told(arm, columns, write, turn, name):
    found, rig = drafted(arm, write(changed(columns, q2=columns["q2"] - turn)))
    assert any(f"q2: zero where the model's joint is at {name}" in words for words in found.look)
    assert rig.description.signals["lift.position"].offset == pytest.approx(turn, rel=1e-6)


@pytest.mark.parametrize("name", ["current1", "motor_current_1", "i_cur1"])
def test_a_current_without_a_unit_is_electrical(arm, columns, write, name):
    log = {{"tau1": name}.get(n, n): v for n, v in columns.items()}
    found, rig = drafted(arm, write(log | {name: log[name] / 2.5}))
    assert any(f"{name} is electrical: 2.5" in words for words in found.look)
    assert scales(rig)["m1.effort"] == pytest.approx(2.5, rel=0.05)


def test_a_constant_that_the_log_does_not_tell_is_not_called_fitted(arm, columns, write):
    log = {{"tau1": "current1"}.get(n, n): v for n, v in columns.items()}
    noise = np.random.default_rng(5).standard_normal(len(columns["t"]))
    found, rig = drafted(arm, write(log | {"current1": noise}))
    words = "1 N*m per A, as nothing tells it"
    assert f"current1 is electrical: {words}; put the motor's constant there" in found.look
    assert any(words in guess.taken_for for guess in found.guesses)
    assert rig.description.tolerances["gain"] == 0.2


@pytest.mark.parametrize("names", [("current_pos1", "tau1"), ("q1", "current_torque1")])
def test_what_is_current_is_no_ampere(arm, columns, write, names):
    log = {dict(zip(("q1", "tau1"), names, strict=True)).get(n, n): v for n, v in columns.items()}
    found, rig = drafted(arm, write(log))
    assert not any("electrical" in words for words in found.look)
    assert {scales(rig)[n] for n in ("turn.position", "m1.effort")} == {1.0}


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torque_a_thousand_times_off_is_told_whatever_its_sign(arm, columns, write, sign):
    found, _ = drafted(arm, write(changed(columns, tau2=sign * 1e3 * columns["tau2"])))
    expected = f"times{', turned,' * (sign < 0.0)} what the model needs: another unit (mN*m?)"
    assert any(expected in words for words in found.look)
    late = {n: v for n, v in columns.items() if n != "t"} | {"time_s": 1e3 * columns["t"]}
    found, _ = drafted(arm, write(changed(late, tau2=1e3 * columns["tau2"])))
    assert any("is that its unit?" in words for words in found.look)
    assert not any("times what the model needs" in words for words in found.look)


def test_a_column_of_revolutions_a_minute_is_a_speed(swing, write):
    path, columns = swing
    log = {{"dq": "rpm"}.get(n, n): v for n, v in columns.items()}
    _, rig = drafted(path, write(log | {"rpm": log["rpm"] * 30.0 / np.pi}))
    assert scales(rig)["joint.speed"] == pytest.approx(np.pi / 30.0)


def test_viscous_friction_of_one_is_no_speed_in_an_effort_s_column(arm, columns, write):
    """A measured wrist, 0.98 N m s/rad; its log has no column of a speed."""
    rubbing = columns["dq3"] + 0.4 * np.std(columns["dq3"]) * np.sin(3.0 * columns["t"])
    log = {n: v for n, v in columns.items() if not n.startswith("dq")} | {"tau3": rubbing}
    found, _ = drafted(arm, write(log))
    assert not any("swapped" in words for words in found.look)
    log["tau3"] = np.gradient(columns["q3"], columns["t"])
    found, _ = drafted(arm, write(log))
    assert any("tau3 is the rate of q3" in words for words in found.look)
