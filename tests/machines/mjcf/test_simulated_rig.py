"""Inverse and forward simulation of a rig against closed forms and against each other."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import final

import numpy as np
import pytest
from two_link import TIME, programme, rig, write_files

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects import ActuatorDelay, Backlash, Effect
from ves_twin.effects.element import Element
from ves_twin.effects.row import Anywhere
from ves_twin.machines.mjcf.motion import inverse
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.inverse import efforts_of_motion
from ves_twin.machines.mjcf.motion.stepping import motion_of_drive
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.recordings.applied import applied
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

INNER = slice(200, -200)
"""Rows that the ends of a zero-phase filter do not reach."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return rig(tmp_path_factory.mktemp("rig"))


def still_arm(x: np.ndarray) -> Excitation:
    fed = programme().drive
    return Excitation(
        "one axis", TIME, {**fed, "cart.position": x[:, None], "arm.angle": 0 * fed["arm.angle"]}
    )


def test_effort_of_a_sinusoid_is_that_of_the_equation_of_motion(machine):
    """(m + a) q'' + c q' + f sign q' + k q of both bodies together, the arm held."""
    w, size = 5.0, 0.1
    x = size * np.sin(w * TIME)
    v, a = w * size * np.cos(w * TIME), -w * w * x
    forward = MjcfForward.of(machine, Mode.MOTION)
    found = forward.simulate(still_arm(x), {"viscous_asymmetry@rail:slope": 2.0})[:, 0]
    mass = 3.1 + 1.0 + 0.2
    expected = mass * a + 4.0 * v + 0.5 * np.sign(v) + 3.0 * x + 2.0 * np.abs(v)
    moving = np.abs(v) > 0.01  # the sign is smoothed over 0.25 mm/s
    gap = (found - expected)[INNER][moving[INNER]]
    # central differences of a 5 rad/s sine at 2 ms: (w h)^2 / 6 = 1.7e-5 of 11 N
    assert np.max(np.abs(gap)) < 1e-3


def test_inverse_dynamics_of_a_simulated_motion_gives_the_force_back(machine):
    """Two independent ways through MuJoCo: implicit steps forward, mj_inverse back."""
    fed = programme()
    effects = {"force_offset@rail:offset": 1.5, "viscous_asymmetry@rail:slope": 3.0}
    forward = MjcfForward.of(machine, Mode.CONTROL)
    names = [c.name for c in forward.channels]
    rows = forward.simulate(fed, effects)
    moved = {
        "cart.position": rows[:, [names.index("cart.position")]],
        "arm.angle": rows[:, [names.index("arm.angle")]],
    }
    back = MjcfForward.of(machine, Mode.MOTION)
    efforts = back.simulate(Excitation("back", TIME, {**fed.drive, **moved}), effects)
    speed = np.gradient(moved["cart.position"][:, 0], TIME)
    sliding = np.abs(speed[INNER]) > 0.05
    # commands are held for a row: what is found is that of half a row before
    asked = np.interp(TIME - 0.001, TIME, fed.drive["drive.force"][:, 0])
    gap = (efforts[:, 0] - asked)[INNER][sliding]
    # friction's solver is soft (5 ms): 2 % of the 15 N that act
    assert np.sqrt(np.mean(gap**2)) < 0.3


def test_a_controller_stands_off_by_the_offset_over_its_gain(machine):
    """kp e = F at rest: 2 N / 400 N/m, within the 0.5 N of dry friction; the spring is on top."""
    steady = {**programme().drive, "cart.set": np.full((len(TIME), 1), 0.05)}
    forward = MjcfForward.of(machine, Mode.REFERENCE)
    rows = forward.simulate(Excitation("hold", TIME, steady), {"force_offset@rail:offset": 2.0})
    at = [c.name for c in forward.channels].index("cart.position")
    end = rows[-1, at]
    assert 400.0 * (0.05 - end) == pytest.approx(2.0 + 3.0 * end, abs=0.5)


def test_halving_the_step_changes_little_and_the_difference_falls_with_it(machine):
    forward = MjcfForward.of(machine, Mode.CONTROL)
    coarse = forward.simulate(programme(), {})
    fine = forward.simulate(programme(), {}, refined=True)
    at = [c.name for c in forward.channels].index("cart.position")
    change = np.max(np.abs(coarse - fine)[:, at])
    # a first-order step of 1 ms on a motion of 0.1 m
    assert 1e-7 < change < 2e-3


@final
@dataclass(frozen=True)
class LongerArm(Effect):
    """An effect of another package: the arm hangs lower on its cart."""

    shift: float = 0.0

    kind = "longer_arm"
    anywhere = Anywhere(Element.BODY, 0.5)

    def edit_model(self, model):
        model.jnt_pos[model.joint("swing").id, 2] += self.shift


def test_an_effect_that_edits_any_number_of_the_model_changes_the_efforts(machine):
    """Through what is kept of earlier motions: as with nothing kept."""
    fed = programme()
    begun = Work.begin(machine, fed, {})
    plain = efforts_of_motion(begun)[0]["drive.force"]
    model = copy.copy(begun.model)
    LongerArm("arm", shift=0.2).edit_model(model)
    found = efforts_of_motion(replace(begun, model=model))[0]["drive.force"]
    inverse._efforts.cache_clear()
    inverse._moved.cache_clear()
    assert np.array_equal(found, efforts_of_motion(replace(begun, model=model))[0]["drive.force"])
    assert np.max(np.abs(found - plain)) > 0.1


@final
@dataclass(frozen=True)
class Limit(Effect):
    """An effect of another package: an amplifier gives no more than this."""

    most: float = 0.0

    kind = "limit"
    anywhere = Anywhere(Element.ACTUATOR, 100.0)

    def edit_command(self, command, time):
        return np.clip(command, -self.most, self.most)


def test_an_effect_on_an_actuator_is_at_work_in_closed_loop_too(machine):
    """A limit below the controller's own is that limit; effects follow one another."""
    fed = replace(programme(), time=TIME[:300])
    fed = replace(fed, drive={n: v[:300] for n, v in fed.drive.items()})
    place = machine.entries[0].place
    limit, late = Limit("drive", most=3.0), ActuatorDelay("drive", delay=0.005)
    controller = machine.description.controllers["drive"]
    told = machine.description.model_copy(
        update={"controllers": {"drive": controller.model_copy(update={"limit": 3.0})}}
    )
    limited = replace(machine, description=told)

    def cart(rig, *effects):
        work = replace(Work.begin(rig, fed, {}), effects=tuple((e, place) for e in effects))
        return motion_of_drive(work, Mode.REFERENCE).signals["cart.position"]

    assert not np.array_equal(cart(machine), cart(limited))
    assert np.array_equal(cart(machine, limit), cart(limited))
    assert np.array_equal(cart(machine, limit, late), cart(limited, late))
    # the delay's own short way against what every effect has
    general = Effect.edit_row(late, np.sin(TIME), TIME, 700)
    assert late.edit_row(np.sin(TIME), TIME, 700) == pytest.approx(general, abs=1e-12)


def test_a_start_may_be_a_text_with_a_unit(tmp_path):
    told = '\n[start.swing]\nposition = "10 deg"\nspeed = "-20 deg/s"\n'
    forward = MjcfForward.of(rig(tmp_path, more=told))
    rows = forward.simulate(programme(), {})
    angle = rows[:, [c.name for c in forward.channels].index("arm.angle")]
    assert angle[0] == pytest.approx(np.radians(10.0), abs=1e-12)
    # gravity and the torque change it by up to 10 % in 2 ms
    assert (angle[1] - angle[0]) / TIME[1] == pytest.approx(np.radians(-20.0), rel=0.2)


@pytest.mark.parametrize("state", ["measured", "estimated"])
def test_a_measured_start_is_the_first_row_also_of_a_signal_that_reads_the_other_way(
    tmp_path, state
):
    """Cart at +0.3 m by a position that counts backwards: -0.3 m of the joint, moving."""
    path = write_files(tmp_path, more='\n[start.swing]\nposition = "measured"\n')
    text = path.read_text().replace('joint = "rail"', 'joint = "rail"\nsign = -1', 1)
    path.write_text(text.replace("[start.rail]", '[start.rail]\nposition = "measured"'))
    machine = Rig.load(str(path))
    fed = {**programme().drive, "cart.position": (0.3 + 0.2 * TIME)[:, None]}
    if state == "estimated":
        moved = Recording(TIME, fed, RecordingInfo("measured", scenario="a"))
        _, machine, _ = applied("a", moved, MjcfExperiment(start={"state": state}), machine)
    forward = MjcfForward.of(machine)
    rows = forward.simulate(Excitation("backwards", TIME, fed), {})
    x = rows[:, [c.name for c in forward.channels].index("cart.position")]
    assert x[0] == pytest.approx(0.3, abs=1e-12)
    # the ends of a zero-phase filter and 4 ms of motion: per cents of 0.2 m/s
    assert (x[2] - x[0]) / (TIME[2] - TIME[0]) == pytest.approx(0.2, rel=0.1)


def test_a_gap_is_crossed_before_the_driven_side_follows():
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.linspace(1.0, 0.0, 101)])
    y = Backlash("swing", gap=0.2).edit_position(x)
    assert y[100] == pytest.approx(0.9)
    assert np.all(y[101:121] == y[100])
    assert y[-1] == pytest.approx(0.1)
    assert Backlash("swing").edit_position(x) is x


@pytest.mark.parametrize("mode", [Mode.CONTROL, Mode.MOTION])
def test_a_prediction_leaves_nothing_to_the_next(machine, mode):
    """Not even one that fell out of MuJoCo's range, nor one that was begun in between."""
    forward, fed = MjcfForward.of(machine, mode), programme()
    before = forward.simulate(fed, {})
    wild = {name: 1e9 * rows for name, rows in fed.drive.items()}
    with np.errstate(all="ignore"):
        forward.simulate(Excitation("wild", TIME, wild), {"viscous_asymmetry@rail:slope": 2.0})
    Work.begin(machine, fed, {"body_mass@cart:mass": 1.0}).data.qpos[:] = 1.0
    assert np.array_equal(forward.simulate(Excitation("again", TIME, fed.drive), {}), before)


@pytest.mark.parametrize(
    ("kind", "target", "size"),
    [
        ("sensor_offset", "arm.angle.1", 0.02),
        ("sensor_gain", "arm.angle.1", 0.1),
        ("sensor_delay", "arm.angle", 0.004),
    ],
)
def test_a_measured_start_is_what_the_sensor_saw_and_not_what_it_read(tmp_path, kind, target, size):
    """The offset of an encoder was added to a start that had it already, and was not believed.

    Recorded with the fault from a known start, and simulated with it from the recorded one.
    """
    fault = f'\n[[effects]]\nkind = "{kind}"\non = ["{target}"]\n'
    typical = '\n[typical.signal."arm.angle"]\nspan = 1.0\n'
    path = write_files(tmp_path, more=f"{fault}{typical}")
    true = MjcfForward.of(Rig.load(str(path)))
    path.write_text(path.read_text() + '\n[start.swing]\nposition = "measured"\n')
    begun = MjcfForward.of(Rig.load(str(path)))
    at = [c.name for c in true.channels].index("arm.angle")
    (name,) = [p.name for p in true.parameters if p.name.startswith(f"{kind}@{target}:")]
    recorded = true.simulate(programme(), {name: size})
    fed = {**programme().drive, "arm.angle": recorded[:, [at]]}
    with_it, without = (
        begun.simulate(Excitation("again", TIME, fed), values)[:, at] - recorded[:, at]
        for values in ({name: size}, {})
    )
    assert abs(with_it[0]) < 1e-6  # a cubic through its first rows
    assert np.max(np.abs(with_it)) < 0.003  # of 3 rad: the speed of the start is known to 0.01
    assert np.max(np.abs(without)) > 0.03


@pytest.mark.parametrize(
    ("kind", "target", "size"),
    [
        ("sensor_offset", "arm.angle.1", 0.05),
        ("sensor_gain", "arm.angle.1", 0.1),
        ("sensor_delay", "arm.angle", 0.02),
    ],
)
def test_a_fault_of_an_encoder_whose_motion_is_fed_in_is_taken_off_that_motion(
    tmp_path, kind, target, size
):
    """Of a series elastic joint 4 ms between two encoders were a third of the effort's error."""
    fault = f'\n[[effects]]\nkind = "{kind}"\non = ["{target}"]\n'
    typical = '\n[typical.signal."arm.angle"]\nspan = 1.0\n'
    path = write_files(tmp_path, more=f"{fault}{typical}")
    forward = MjcfForward.of(Rig.load(str(path)), Mode.MOTION)
    (name,) = [p.name for p in forward.parameters if p.name.startswith(f"{kind}@{target}:")]
    true = programme().drive["arm.angle"]
    read = {
        "sensor_offset": true + size,
        "sensor_gain": (1.0 + size) * true,
        "sensor_delay": np.interp(TIME - size, TIME, true[:, 0])[:, None],
    }
    fed = {**programme().drive, "arm.angle": read[kind]}
    right = forward.simulate(programme(), {})[INNER]
    known = forward.simulate(Excitation("known", TIME, fed), {name: size})[INNER]
    unknown = forward.simulate(Excitation("unknown", TIME, fed), {})[INNER]
    off = np.max(np.abs(unknown - right))
    assert off > 0.1
    assert np.max(np.abs(known - right)) < 0.02 * off  # linear between rows, for a delay
