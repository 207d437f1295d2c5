"""A cubic spring, friction by load, a body's place and the direction of gravity: their physics."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from two_link import TIME, programme, rig

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects import JointCompliance
from ves_twin.effects.element import Element
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode, Setting

INNER = slice(200, -200)
"""Rows that the ends of a zero-phase filter do not reach."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return rig(tmp_path_factory.mktemp("rig"), "motion")


def efforts(machine, fed, **values):
    forward = MjcfForward.of(machine, Mode.MOTION)
    rows = forward.simulate(fed, values)
    names = [c.name for c in forward.channels]
    return {n: rows[:, names.index(n)] for n in ("drive.force", "hinge.torque")}


def change(machine, fed, **values):
    with_it, without = efforts(machine, fed, **values), efforts(machine, fed)
    return {name: with_it[name] - without[name] for name in with_it}


def round_trip(machine, value) -> float:
    """Rms [N] of the force that inverse dynamics asks for a simulated motion, less the one fed."""
    fed = programme()
    forward = MjcfForward.of(machine, Mode.CONTROL)
    rows = forward.simulate(fed, value)
    names = [c.name for c in forward.channels]
    moved = {n: rows[:, [names.index(n)]] for n in ("cart.position", "arm.angle")}
    back = efforts(machine, Excitation("back", TIME, {**fed.drive, **moved}), **value)
    speed = np.gradient(moved["cart.position"][:, 0], TIME)[INNER]
    asked = np.interp(TIME - 0.001, TIME, fed.drive["drive.force"][:, 0])
    gap = (back["drive.force"] - asked)[INNER][np.abs(speed) > 0.05]
    return float(np.sqrt(np.mean(gap**2)))


def test_a_cubic_spring_pulls_with_the_cube_of_its_travel(machine):
    fed = programme()
    found = change(machine, fed, **{"cubic_spring@rail:stiffness": 2e3})["drive.force"]
    expected = 2e3 * fed.drive["cart.position"][:, 0] ** 3
    # the low-pass of 60 Hz passes a motion of half a hertz
    assert found[INNER] == pytest.approx(expected[INNER], abs=1e-4 * np.max(expected))


def test_forward_and_inverse_agree_about_a_cubic_spring(machine):
    """Through MuJoCo's own steps, and back through its inverse dynamics."""
    assert (
        round_trip(machine, {"cubic_spring@rail:stiffness": 2e3}) < 0.3
    )  # soft friction: 2 % of 15 N


def test_a_compliance_adds_to_that_of_the_spring(machine):
    fed = programme()
    found = change(machine, fed, **{"joint_compliance@rail:compliance": 1.0})["drive.force"]
    place = fed.drive["cart.position"][:, 0]
    stiffness = 1.0 / (1.0 / 3.0 + 1.0)  # the model's is 3 N/m
    expected = (stiffness - 3.0) * place
    assert found[INNER] == pytest.approx(expected[INNER], abs=1e-4 * np.max(expected))


def test_a_joint_without_a_spring_has_no_compliance():
    place = Place(Element.JOINT, "swing", effort=1.0, speed=1.0, travel=1.0)
    with pytest.raises(InvalidInputError, match=r"joint_compliance.*swing.*has a stiffness"):
        JointCompliance.magnitudes_at(place)


def with_rail(machine, **changes):
    """The machine's description with a stiffness of the rail, or anything else."""
    return replace(machine, description=machine.description.model_copy(update=changes))


def test_a_spring_that_was_fitted_away_still_has_a_compliance_in_the_library(machine):
    gone = Setting(joint="rail", attribute="stiffness", value=0.0, sd=1.0)
    kept = [p for p in machine.description.parameters if p.joint != "rail"]
    one = with_rail(machine, parameters=(*kept, gone))
    fed = programme()
    assert "joint_compliance@rail" in {h.label for h in MjcfForward.of(one).hypotheses}
    softer = change(one, fed, **{"joint_compliance@rail:compliance": 1.0})["drive.force"]
    assert not np.any(softer[INNER])


def test_the_largest_compliance_of_a_spring_that_was_nearly_fitted_away_is_that_of_a_soft_one(
    machine,
):
    def largest(value):
        left = Setting(joint="rail", attribute="stiffness", value=value, sd=1.0)
        kept = [p for p in machine.description.parameters if p.joint != "rail"]
        forward = MjcfForward.of(with_rail(machine, parameters=(*kept, left)))
        return {h.label: h.largest[0] for h in forward.hypotheses}["joint_compliance@rail"]

    assert largest(1e-9) == pytest.approx(largest(0.0), rel=1e-9)
    assert largest(1e6) < largest(1e-9)


def test_a_compliance_below_zero_is_refused(machine):
    one = with_rail(machine, present={"joint_compliance": {"rail": {"compliance": -0.3}}})
    with pytest.raises(InvalidInputError, match=r"joint_compliance\.rail\.compliance.*at least 0"):
        one.check()


def test_friction_by_load_is_a_share_of_what_the_joint_carries(machine):
    fed = programme()
    found = change(machine, fed, **{"load_friction@rail:share": 0.1})["drive.force"]
    speed = np.gradient(fed.drive["cart.position"][:, 0], TIME)
    own = 4.0 * speed + 0.5 * np.sign(speed)  # damping and friction loss of the model
    load = efforts(machine, fed)["drive.force"] - own
    moving = np.abs(speed[INNER]) > 0.01
    expected = (0.1 * np.abs(load) * np.sign(speed))[INNER][moving]
    assert found[INNER][moving] == pytest.approx(expected, abs=0.01 * np.max(np.abs(expected)))


def test_friction_by_load_slows_a_simulated_cart_as_its_inverse_says(machine):
    # what the joint carries holds its own friction loss and damping, which inverse takes out
    asked = 0.3 + 0.2 * (0.5 + 4.0 * 0.3)
    assert round_trip(machine, {"load_friction@rail:share": 0.2}) < asked


def test_turned_gravity_loads_a_machine_that_rests(machine):
    zero = {name: 0.0 * values for name, values in programme().drive.items()}
    fed = Excitation("rests", TIME, zero)
    found = change(machine, fed, **{"gravity_direction@y:angle": 0.1})
    model = machine.model
    mass = float(model.body_subtreemass[model.body("cart").id])
    # turned about y by 0.1 gravity has -g sin 0.1 along x, and the drive holds against it
    assert found["drive.force"][INNER] == pytest.approx(mass * 9.81 * np.sin(0.1), rel=1e-6)


def test_a_body_farther_out_takes_its_weight_with_it(machine):
    fed = programme()
    still = {**fed.drive, "arm.angle": 0.0 * fed.drive["arm.angle"] + 0.3}
    rests = Excitation("rests", TIME, {**still, "cart.position": 0.0 * still["cart.position"]})
    found = change(machine, rests, **{"body_place@hook.z:shift": -0.5})["hinge.torque"]  # from -0.4
    data = mujoco.MjData(machine.model)
    data.qpos[machine.model.joint("swing").qposadr[0]] = 0.3
    mujoco.mj_forward(machine.model, data)
    down = data.xmat[machine.model.body("arm").id].reshape(3, 3) @ [0.0, 0.0, -0.1]
    mass = float(machine.model.body_mass[machine.model.body("hook").id])
    assert found[INNER] == pytest.approx(-mass * 9.81 * down[0], rel=1e-6)
