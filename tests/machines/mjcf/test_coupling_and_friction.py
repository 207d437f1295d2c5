"""What couples two joints, and friction that is more than a sign: laws of the physics."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects import ActuatorDeadband, FrictionBehindGap, StribeckFriction
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="one"><joint name="a" axis="0 0 1"/><geom size="0.1" mass="1" pos="0.3 0 0"/>
      <body name="two" pos="0.5 0 0"><joint name="b" axis="0 0 1"/>
        <geom size="0.1" mass="1" pos="0.3 0 0"/></body></body>
    <body name="car"><joint name="c" type="slide"/><geom size="0.1" mass="1"/></body>
  </worldbody>
  <tendon>
    <fixed name="sum" stiffness="0.3" solreffriction="0.004 1">
      <joint joint="a" coef="1"/><joint joint="b" coef="1"/></fixed>
    <fixed name="mixed"><joint joint="a" coef="1"/><joint joint="c" coef="1"/></fixed>
  </tendon>
  <actuator><motor name="ma" joint="a"/><motor name="mb" joint="b"/></actuator>
</mujoco>
"""

TOML = """
schema = 1
kind = "rig"
name = "coupled"
model = "coupled.xml"
[clock]
column = "t"
[drive]
mode = "motion"
smoothing = "200 Hz"
joints = {{ a = "a", b = "b" }}
locked = ["c"]
actuators = {{ ma = "ta", mb = "tb" }}
[typical.joint.a]
effort = 5
speed = 2
travel = 1
[typical.joint.b]
effort = 5
speed = 2
travel = 1
[typical.joint.c]
effort = 5
speed = 2
travel = 1
"""
SIGNALS = """
[signals.{0}]
columns = ["{0}"]
unit = "{1}"
noise = 0.001
[compare.{0}]
{2}
"""
EFFECTS = """
[[effects]]
kind = "{0}"
on = ["{1}"]
"""
T = 0.001 * np.arange(3000)
FED = {"a": 0.5 * np.sin(3 * T), "b": 0.4 * np.sin(5 * T + 1)}


def coupled(folder: Path, *effects: tuple[str, str]) -> Rig:
    (folder / "coupled.xml").write_text(MODEL)
    text = TOML.format()
    for name, unit, where in (
        ("a", "rad", 'joint = "a"'),
        ("b", "rad", 'joint = "b"'),
        ("ta", "N*m", 'actuator = "ma"'),
        ("tb", "N*m", 'actuator = "mb"'),
    ):
        text += SIGNALS.format(name, unit, where)
    text += "".join(EFFECTS.format(*e) for e in effects)
    (folder / "coupled.toml").write_text(text)
    return Rig.load(str(folder / "coupled.toml"))


KINDS = ("coupling_viscous", "coupling_coulomb", "coupling_inertia", "coupling_spring")


@pytest.mark.parametrize("kind", KINDS)
def test_a_coupling_acts_on_both_joints_alike_and_follows_the_sum_of_their_motions(tmp_path, kind):
    forward = MjcfForward.of(coupled(tmp_path, (kind, "sum")))
    (parameter,) = forward.parameters
    programme = Excitation("", T, {n: v[:, None] for n, v in FED.items()})
    rest = parameter.nominal
    with_it, without = (forward.simulate(programme, {parameter.name: x + rest}) for x in (0.3, 0.0))
    change = with_it - without
    speed = np.gradient(FED["a"] + FED["b"], 0.001)
    expected = {
        "coupling_viscous": 0.3 * speed,
        "coupling_coulomb": 0.3 * np.sign(speed),
        "coupling_inertia": 0.3 * np.gradient(speed, 0.001),
        "coupling_spring": 0.3 * (FED["a"] + FED["b"]),
    }[kind]
    inside = slice(50, -50)  # away from the ends, where the low-pass has no neighbours
    clear = np.abs(speed[inside]) > 0.05
    assert np.allclose(change[:, 0], change[:, 1], atol=1e-9)
    assert change[inside, 0][clear] == pytest.approx(expected[inside][clear], rel=0.02, abs=0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_simulated_forward_a_coupling_is_the_tendon_of_mujoco(tmp_path, kind):
    """What the motion of such a machine needs, computed backwards, is what was fed in."""
    rig = coupled(tmp_path, (kind, "sum"))
    one = MjcfForward.of(rig).parameters[0]
    name, size = one.name, one.nominal + 0.2
    torque = {"ta": 2 * np.sin(4 * T), "tb": np.sin(6 * T)}
    fed = {n: v[:, None] for n, v in torque.items()}
    forward = MjcfForward.of(rig, Mode.CONTROL)
    path = forward.simulate(Excitation("", T, fed), {name: size})
    back = MjcfForward.of(rig)
    along = Excitation("", T, {"a": path[:, :1], "b": path[:, 1:2]})
    needed = back.simulate(along, {name: size})
    off = np.sqrt(np.mean(np.square(needed - np.stack(list(torque.values()), 1))[100:-100]))
    without = np.sqrt(
        np.mean(np.square(back.simulate(along, {}) - np.stack(list(torque.values()), 1))[100:-100])
    )
    assert off < 0.15 * without


def test_a_tendon_over_a_hinge_and_a_slide_is_refused_by_name(tmp_path):
    with pytest.raises(InvalidInputError, match=r"tendon mixed.*all turn, or all slide"):
        coupled(tmp_path, ("coupling_viscous", "mixed"))


def test_friction_behind_a_gap_moves_free_inside_it_then_loads_its_spring_then_slips():
    effect = FrictionBehindGap("a", level=10.0, travel=0.1, gap=0.4)
    x = np.concatenate([np.linspace(0, 1, 1001), np.linspace(1, 0, 1001)])
    effort = effect.hold(x)
    assert effort[x <= 0.2][:200] == pytest.approx(0.0)  # half the gap
    assert effort[250] == pytest.approx(10.0 * 0.05 / 0.1)  # half the elastic travel
    assert effort[301:1001] == pytest.approx(10.0)
    back = effort[1001:]
    assert back[150] == pytest.approx(0.0)  # the spring is unloaded, and the gap not yet crossed
    assert back[-1] == pytest.approx(-10.0)


@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_friction_behind_a_gap_takes_energy_out_of_every_cycle(gap):
    effect = FrictionBehindGap("a", level=3.0, difference=0.2, travel=0.05, gap=gap)
    x = 0.5 * np.sin(np.linspace(0, 6 * np.pi, 6001))
    work = np.sum(effect.hold(x)[2000:4001][:-1] * np.diff(x[2000:4001]))
    amplitude = 2 * (0.5 * 2 - gap - 2 * 0.05)  # slip there and back, without gap and springs
    assert work == pytest.approx(3.0 * amplitude, rel=0.01)


def test_without_gap_and_travel_it_is_dry_friction():
    effect = FrictionBehindGap("a", level=3.0)
    x = np.sin(np.linspace(0, 10, 5000))
    moving = np.abs(np.gradient(x)) > 1e-5
    moving[0] = False  # the slider begins where the motion does
    assert effect.hold(x)[moving] == pytest.approx(3.0 * np.sign(np.gradient(x))[moving])


def test_stribeck_friction_is_full_when_slow_and_gone_when_fast():
    effect = StribeckFriction("a", level=2.0, fall=0.1)
    force = effect.resist(np.array([0.01, -0.01, 0.5]), 1e-4)
    assert force == pytest.approx([2.0, -2.0, 0.0], rel=0.02, abs=1e-6)


def test_an_extended_machine_with_a_coupling_loads_again_with_it(tmp_path):
    from ves_twin.machines.mjcf.rig.description import Setting
    from ves_twin.machines.mjcf.rig.extend import write_rig

    rig = coupled(tmp_path, ("coupling_viscous", "sum"))
    told = rig.description.model_copy(
        update={"parameters": (Setting(tendon="sum", attribute="damping", value=0.25),)}
    )
    write_rig(Rig(told, rig.folder, rig.file), tmp_path / "more.toml")
    model = Rig.load(str(tmp_path / "more.toml")).model
    assert float(model.tendon_damping[model.tendon("sum").id]) == 0.25
    assert isinstance(model, mujoco.MjModel)


def test_commands_inside_a_dead_band_do_nothing_and_the_command_of_an_effort_lies_beyond_it():
    effect = ActuatorDeadband("ma", band=0.5)
    command = np.array([-2.0, -0.5, -0.3, 0.0, 0.2, 0.5, 1.5])
    given = effect.edit_command(command, np.arange(7.0))
    assert given.tolist() == [-1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    outside = np.abs(command) > 0.5
    assert np.array_equal(effect.edit_required(given, np.arange(7.0))[outside], command[outside])
    rows = [effect.edit_row(command, np.arange(7.0), k) for k in range(7)]
    assert rows == given.tolist()
