"""Columns that cannot be right by themselves, told before any fit: no sign, swapped, two runs."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted

from ves_twin.cli.new_text import new_text
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.new_machine import new_machine

SLIDER = """
<mujoco model="slider">
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 {weight}"/>
  <worldbody><body name="rod"><joint name="stroke" type="slide" axis="0 0 1" damping="60"/>
    <geom type="box" size="0.05 0.01 0.01" mass="1"/></body></worldbody>
  <actuator><motor name="motor" joint="stroke"/></actuator>
</mujoco>
"""


@pytest.fixture(params=[0.0, -9.81])
def slider(request, tmp_path):
    """A slow slider's file and log at 50 Hz: to and fro by a force, its weight held up or none."""
    path = tmp_path / "slider.xml"
    path.write_text(SLIDER.format(weight=request.param))
    model = mujoco.MjModel.from_xml_path(str(path))
    data, rows = mujoco.MjData(model), np.zeros((1500, 3))
    rng = np.random.default_rng(4)
    for k in range(len(rows)):
        force = 6.0 * np.sin(0.02 * k) + 2.0 * np.sin(0.053 * k) - request.param
        rows[k] = 0.02 * k, force, data.qpos[0] + 1e-5 * rng.standard_normal()
        data.ctrl[0] = force
        mujoco.mj_step(model, data, 20)
    return path, dict(zip(("t", "pwm", "y"), rows.T, strict=True)), request.param


def test_a_command_without_its_sign_is_told_and_one_that_holds_a_weight_is_none(slider, write):
    """A Stewart platform's leg, logged by its duty alone: nothing was found, nobody said why."""
    path, columns, weight = slider
    found, _ = drafted(path, write(changed(columns, pwm=np.abs(columns["pwm"]))))
    said = [words for words in found.look if "pwm is never below zero" in words]
    assert bool(said) == (weight == 0.0)
    if said:
        assert "though stroke moves both ways" in said[0]
    found, _ = drafted(path, write(columns, "signed.csv"))
    assert not any("never below zero" in words for words in found.look)


def test_two_runs_on_one_clock_are_told_at_their_seam(slider, write):
    path, columns, _ = slider
    other = 500 + int(np.argmax(np.abs(columns["y"][500:1200] - columns["y"][499])))
    kept = np.r_[0:500, other:1500]
    log = {name: rows[kept] for name, rows in columns.items()}
    log["t"] = 0.02 * np.arange(len(kept))
    found, _ = drafted(path, write(log))
    assert any("at 9.98 s and stays: two runs in one log" in words for words in found.look)
    found, _ = drafted(path, write(columns, "one.csv"))
    assert not any("two runs" in words for words in found.look)


def test_a_move_that_a_slow_log_missed_is_no_seam(slider, write):
    """A hobby servo at 10 Hz stands elsewhere in the next row, as its command asked."""
    path, columns, _ = slider
    place = np.where(np.arange(1500) < 700, 0.1, 0.3) + 1e-5 * np.sin(np.arange(1500))
    asked = np.where(np.arange(1500) < 699, 0.1, 0.3)
    log = {"t": 0.1 * np.arange(1500), "pwm": 20.0 * asked, "y": place}
    assert not any("two runs" in words for words in drafted(path, write(log))[0].look)
    log["pwm"] = columns["pwm"]
    found, _ = drafted(path, write(log, "unasked.csv"))
    assert any("y jumps from 0.1 to 0.3 at 69.9 s" in words for words in found.look)


def test_a_pulse_about_its_middle_lacks_no_sign(slider, write):
    path, columns, _ = slider
    pulse = 1500.0 + 20.0 * (columns["pwm"] - np.mean(columns["pwm"]))
    log = {"t": columns["t"], "pulse_us": pulse, "y": columns["y"]}
    found, rig = drafted(path, write(log))
    assert not any("never below zero" in words for words in found.look)
    assert not widened(rig, "force_offset")  # nothing tells what one microsecond is


def test_a_joint_that_is_held_is_not_swapped_with_the_effort_that_holds_it(slider, write):
    path, columns, _ = slider
    held = 0.1 + 2e-5 * np.random.default_rng(0).standard_normal(1500)
    found, _ = drafted(path, write(changed(columns, y=held)))
    assert not any("up and down" in words for words in found.look)


def test_a_glitch_of_a_sensor_is_told(slider, write):
    path, columns, _ = slider
    y = columns["y"].copy()
    y[[100, 900]] += 0.3
    found, _ = drafted(path, write(changed(columns, y=y)))
    assert any("y is far from its neighbours in 2 single rows" in words for words in found.look)


def test_a_current_and_an_angle_under_each_others_names_are_told(swing, write):
    path, columns = swing
    noise = 0.3 * np.random.default_rng(2).standard_normal(len(columns["t"]))
    log = {"t": columns["t"], "q": columns["tau"] + noise, "tau": columns["q"]}
    found, _ = drafted(path, write(log))
    assert any(
        "q goes up and down from row to row as no position does, and tau does not: are the two"
        in words
        for words in found.look
    )
    found, _ = drafted(path, write({**columns, "tau": log["q"]}, "right.csv"))
    assert not any("up and down" in words for words in found.look)


def test_no_constant_is_read_off_a_position_in_steps_that_are_all_of_its_acceleration(
    tmp_path, write
):
    """A servo's 1 degree at 400 Hz made 14.2 N m per A of 0.17, and that was told as too small."""
    path = tmp_path / "servo.xml"
    path.write_text(
        '<mujoco model="servo"><worldbody><body><joint name="shaft" damping="0.02"/>'
        '<geom type="cylinder" size="0.05 0.01" mass="0.3"/></body></worldbody>'
        '<actuator><motor name="motor" joint="shaft"/></actuator></mujoco>'
    )
    time, rng = np.arange(400) / 400.0, np.random.default_rng(3)
    swing = np.degrees(0.1 * time + 0.02 * np.sin(5.0 * time))
    angle = np.round(swing + 0.3 * rng.standard_normal(400))
    current = 0.5 + 0.05 * rng.standard_normal(400) + 0.02 * np.gradient(np.gradient(angle))
    found, rig = drafted(path, write({"t": time, "angle_deg": angle, "current_A": current}))
    assert any("current_A: no constant is read off it: noise of angle_deg" in w for w in found.look)
    assert rig.description.signals["motor.effort"].scale == 1.0
    assert not any("never below zero" in words for words in found.look)  # a load that stays
    log = {"t": time, "angle_deg": np.degrees(0.6 * np.sin(5.0 * time))}
    inertia = mujoco.MjModel.from_xml_path(str(path)).dof_M0[0]
    torque = -15.0 * inertia * np.sin(5.0 * time) + 3e-4 * np.cos(5.0 * time)
    found, rig = drafted(path, write({**log, "current_A": torque / 0.17}, "smooth.csv"))
    assert rig.description.signals["motor.effort"].scale == pytest.approx(0.17, rel=0.1)


def test_the_rate_of_a_draft_is_no_higher_than_that_of_its_log(slider, write):
    path, columns, _ = slider
    slow = {name: rows[::5] for name, rows in columns.items()}
    found, rig = drafted(path, write(slow))
    assert "every row" in found.text
    assert rig.description.rate == 10.0


def widened(rig, kind):
    return [e for e in rig.description.effects if e.kind == kind and e.largest]


def test_a_constant_that_a_log_shows_is_within_the_range_of_a_draft(swing, write):
    """A rotor about its pulse at rest: half of its swing was the range, and twice that was there."""
    path, columns = swing
    _, rig = drafted(path, write(columns))
    assert not widened(rig, "force_offset")
    found, rig = drafted(path, write(changed(columns, tau=columns["tau"] + 0.9), "off.csv"))
    (offset,) = widened(rig, "force_offset")
    assert (offset.on, offset.largest) == (("joint",), "1.8 N*m")
    assert "joint: by the efforts in the log" in found.text


def test_delays_of_a_slow_log_have_room_for_some_of_its_rows(slider, write):
    path, columns, _ = slider
    _, rig = drafted(path, write({name: rows[::5] for name, rows in columns.items()}))
    (delay,) = widened(rig, "actuator_delay")
    assert (delay.on, delay.largest) == (("motor",), "0.3 s")
    _, rig = drafted(path, write({**columns, "t": 0.2 * columns["t"]}, "fast.csv"))
    assert not widened(rig, "actuator_delay")


def test_a_draft_of_two_logs_leaves_rows_enough_of_the_shorter_one(slider, write):
    """A draft's own next command failed: 69 rows of a held-out log, of 157."""
    path, columns, _ = slider
    slow = {name: rows[::5] for name, rows in columns.items()}
    logs = [write(slow, "a.csv"), write({n: rows[:140] for n, rows in slow.items()}, "b.csv")]
    told = draft(path, logs, path.with_name("two.toml"))
    assert not told.short
    assert "rate = 10 " in told.text


def test_logs_at_other_rates_are_compared_by_their_lengths(slider, write):
    path, columns, _ = slider
    slow = {name: rows[::10] for name, rows in columns.items()}
    logs = [write(columns, "a.csv"), write(slow, "b.csv")]
    one = draft(path, logs[:1], path.with_name("one.toml"))
    two = draft(path, logs, path.with_name("two.toml"))
    assert two.mode == one.mode


def test_a_joint_of_any_alphabet_gets_its_range(tmp_path, swing, write):
    path, columns = swing
    other = tmp_path / "other.xml"
    other.write_text(
        path.read_text()
        .replace('name="joint"', 'name="hüb"')
        .replace('joint="joint"', 'joint="hüb"'),
        encoding="utf-8",
    )
    found, rig = drafted(other, write(changed(columns, tau=columns["tau"] + 0.9)))
    assert [e.on for e in widened(rig, "force_offset")] == [("hüb",)]
    assert 'on = ["hüb"]' in found.text


def test_a_clock_in_another_unit_is_the_first_thing_to_see_to(slider, write):
    """Rows 100 s apart: stretches of 15 000 s were advised to be held out."""
    path, columns, _ = slider
    log = write({"time_s": 5000.0 * columns["t"], "pwm": columns["pwm"], "y": columns["y"]})
    made = new_machine(path, [log], path.with_name("my.toml"))
    text = new_text(made, path, [log])
    assert "next      see to the unit of the clock (look), and draft again; then" in text
    assert "--alternate" not in text
