"""What a draft says of simulations that run away, of clocks, and of motors that no column tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drafted import drafted

from ves_twin.cli.new_text import new_text
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.new_machine import new_machine

CART = """
<mujoco model="cart">
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body name="cart"><joint name="rail" type="slide" axis="1 0 0"/>
    <inertial pos="0 0 0" mass="6" diaginertia="0.1 0.1 0.1"/>
    <body name="rod"><joint name="swing" axis="0 1 0" damping="0.02"/>
      <inertial pos="0 0 -0.8" mass="0.5" diaginertia="0.001 0.001 0.001"/></body></body></worldbody>
  <actuator><motor name="belt" joint="rail"/></actuator>
</mujoco>
"""


def test_a_simulation_that_runs_away_is_told_with_how_far_and_what_may_lack(tmp_path, write):
    """Of a crane whose model has no friction "0 %" was told, and right columns were suspected."""
    model, rng = tmp_path / "cart.xml", np.random.default_rng(3)
    model.write_text(CART)
    t = 0.01 * np.arange(3000)
    x, v = 0.05 * (1.0 - np.cos(1.3 * t)), 0.065 * np.sin(1.3 * t)
    effort = 6.0 * 0.0845 * np.cos(1.3 * t) + np.where(v > 0.0, 3.0, -2.2)
    place = x + 2e-5 * rng.standard_normal(len(t))
    angle = 0.0086 * np.cos(1.3 * t) + 4e-4 * rng.standard_normal(len(t))
    columns = {"t": t, "belt_N": effort, "rail_m": place, "swing_rad": angle}
    found, _ = drafted(model, write(columns))
    words = " ".join(found.look)
    assert "simulated, rail.position runs" in words
    assert "has a joint no damping or friction in the model?" in words
    assert "smaller timestep" not in words
    assert min(found.explained.values()) == 0.0


@pytest.mark.parametrize(("factor", "asked"), [(1.0, False), (1000.0, True), (1e-4, True)])
def test_rows_that_no_machine_is_logged_at_ask_for_the_unit_of_the_clock(
    swing, write, factor, asked
):
    """Milliseconds taken for seconds made a motor's constant of 5e5."""
    named = {("t [s]" if name == "t" else name): rows for name, rows in swing[1].items()}
    found, _ = drafted(swing[0], write(named | {"t [s]": factor * swing[1]["t"]}))
    assert ("apart: is that its unit?" in " ".join(found.look)) is asked


def test_milliseconds_under_a_bare_name_are_read_as_such_and_said_with_their_rate(
    arm, columns, write
):
    """Rows 10 s apart, as of seconds, are those of no machine."""
    time = {"t": 2000.0 * columns["t"] + 0.25}
    found, _ = drafted(arm, write({n: v for n, v in columns.items() if n[0] != "d"} | time))
    assert "no unit is given, ms is a guess, which makes 100 Hz" in " ".join(found.look)
    far, _ = drafted(arm, write({n: v for n, v in columns.items() if n[0] != "d"} | slow(columns)))
    assert "rows are 2e+06 s apart: is that its unit?" in " ".join(far.look)


def slow(columns):
    """A clock that no unit explains: few rows are left, which no filter takes."""
    return {"t": 4e8 * columns["t"] + 0.25}


def test_a_motor_of_a_tendon_that_no_column_tells_is_no_joints(tmp_path, swing, write):
    """Its tendon's number was taken for a joint's: there are more tendons than joints."""
    one = '<fixed name="t{}"><joint joint="joint" coef="1"/></fixed>'
    tendons = f"<tendon>{one.format(1)}{one.format(2)}</tendon>"
    model = tmp_path / "pulled.xml"
    text = swing[0].read_text().replace("<actuator>", f"{tendons}<actuator>", 1)
    model.write_text(text.replace("</actuator>", '<motor name="pull" tendon="t2"/></actuator>', 1))
    found, _ = drafted(model, write(swing[1]))
    assert min(found.explained.values()) > 0.8


@pytest.mark.parametrize(
    ("explained", "words"),
    [
        ({"tau1": 0.9, "tau2": 0.2}, ""),
        ({"tau1": 0.9, "tau2": 0.0}, "look whether tau2 is what it is taken for, and"),
        ({"tau1": 0.9, "tau2": 0.0, "tau3": 0.01}, "look whether tau2, tau3 are what they are"),
        ({"tau1": 0.01, "tau2": 0.0}, "look whether each column is what it is taken for"),
    ],
)
def test_a_column_of_which_the_model_explains_nothing_is_to_be_looked_at_first(
    arm, columns, write, explained, words
):
    """An elbow's angle told from the world left 0 % of its torque explained, and no word of it."""
    log = write(columns)
    made = new_machine(arm, [log], arm.with_name("my.toml"))
    text = new_text(replace(made, draft=replace(made.draft, explained=explained)), arm, [log])
    (told,) = (line for line in text.splitlines() if line.startswith("  next"))
    assert told.removeprefix("  next      ").startswith(words or "ves-twin diagnose")


def test_no_constant_is_read_off_a_current_of_a_few_steps(arm, columns, write):
    """Currents of a wrist, 0.001 A fine and 0.002 A large, made 2470 N m per A."""
    kept = {n: v for n, v in columns.items() if n[0] != "d" and not n.startswith("tau")}
    fine = {f"i{k}_A": 0.1 * columns[f"tau{k}"] for k in (1, 2)}
    dithered = 0.1 * columns["tau3"] / np.std(columns["tau3"])
    dithered = dithered + 1.5 * np.random.default_rng(1).standard_normal(len(dithered))
    rough = np.round(dithered) / 1000.0
    found, rig = drafted(arm, write({**kept, **fine, "i3_A": rough}))
    assert "i3_A moves by a few steps of its resolution" in " ".join(found.look)
    scales = {s.actuator: s.scale for s in rig.description.signals.values() if s.actuator}
    assert scales["m3"] == 1.0
    assert scales["m1"] == pytest.approx(10.0, rel=0.1)


def test_volts_in_steps_are_not_coarse(swing, write):
    """Six voltages held for seconds, as in a motor's step test, tell its constant."""
    columns = swing[1]
    volts = np.repeat([-12.0, -6.0, 0.0, 6.0, 12.0, 3.0], 250)
    relay = np.where(np.sin(2.0 * np.arange(1500.0)) > 0.0, 24.0, -24.0)
    log = LogColumns.read(write({"t": columns["t"], "u_V": volts, "relay_V": relay}))
    rough = np.round(3.0 * np.sin(0.05 * np.arange(1500)) + np.tile([0.0, 0.6], 750))
    other = LogColumns.read(write({"t": columns["t"], "i_A": 0.001 * rough}, "other.csv"))
    assert not log.is_coarse("u_V")
    assert not log.is_coarse("relay_V")
    assert other.is_coarse("i_A")


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        (1500, "--alternate 2 "),
        (210, "--alternate 1 "),  # no usual one
        (190, "held out  too short for --alternate: give a second log as --held-out"),
    ],
)
def test_a_length_of_stretches_is_told_or_that_there_is_none(swing, write, rows, told):
    path, columns = swing
    log = write({name: values[:rows] for name, values in columns.items()})
    made = new_machine(path, [log], path.with_name("my.toml"))
    text = new_text(made, path, [log])
    assert told in text
    assert ("--held-out" in text) is ("--held-out" in told)
    assert "held out  too short" not in new_text(made, path, [log, log])
