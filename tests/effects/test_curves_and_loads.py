"""Curves of an actuator against their closed forms, and a load that acts one way alone."""

import numpy as np
import pytest

from ves_twin.effects import (
    ActuatorAsymmetry,
    ActuatorDeadband,
    ActuatorDelay,
    ActuatorOffset,
    ActuatorSaturation,
    Effect,
    JointSpring,
    OneWayLoad,
    RegularizedFriction,
)
from ves_twin.effects.element import Element
from ves_twin.effects.place import Place
from ves_twin.effects.registry import EFFECTS

TIME = 0.01 * np.arange(200)
COMMAND = 2.0 * np.sin(3.0 * TIME)

CURVES = [
    kind
    for kind in EFFECTS.values()
    if kind.anywhere and kind.anywhere.element is Element.ACTUATOR and not kind.anywhere.attribute
]


def sized(kind: type[Effect]) -> Effect:
    return kind("drive", *[0.3] * len(kind.sizes))


@pytest.mark.parametrize("kind", CURVES)
def test_the_command_that_an_effort_needs_gives_that_effort(kind):
    effect = sized(kind)
    effort = effect.edit_command(COMMAND, TIME)
    again = effect.edit_command(effect.edit_required(effort, TIME), TIME)
    settled = slice(40, -40) if kind is ActuatorDelay else slice(None)
    np.testing.assert_allclose(again[settled], effort[settled], atol=2e-3)


@pytest.mark.parametrize("kind", CURVES)
def test_a_closed_loop_gives_row_by_row_what_open_loop_gives_at_once(kind):
    effect = sized(kind)
    rows = [effect.edit_row(COMMAND, TIME, k) for k in range(len(TIME))]
    np.testing.assert_allclose(rows, effect.edit_command(COMMAND, TIME), atol=1e-12)


def test_each_curve_is_its_closed_form():
    u = np.array([-2.0, -1.0, 0.0, 0.5, 2.0])
    found = {
        ActuatorOffset("a", offset=0.25): u + 0.25,
        ActuatorDeadband("a", band=0.75): [-1.25, -0.25, 0.0, 0.0, 1.25],
        ActuatorAsymmetry("a", share=0.25): [-1.5, -0.75, 0.0, 0.625, 2.5],
        ActuatorSaturation("a", share=1.0, limit=0.75): [-0.75, -0.75, 0.0, 0.5, 0.75],
        ActuatorSaturation("a", share=0.5, limit=1.0): [-1.5, -1.0, 0.0, 0.5, 1.5],
    }
    for effect, expected in found.items():
        np.testing.assert_allclose(effect.edit_command(u, u), expected, err_msg=str(effect))


def test_no_more_than_its_limit_comes_of_a_saturated_actuator_and_more_asks_for_much():
    effect = ActuatorSaturation("a", share=1.0, limit=1.0)
    (needed,) = effect.edit_required(np.array([1.1]), TIME)
    assert 2.0 < needed < np.inf


def test_a_load_resists_one_way_holds_and_is_gone_on_the_way_back():
    out, back = np.linspace(0.0, 0.05, 51), np.linspace(0.05, 0.0, 51)
    path = np.concatenate([out, np.full(20, 0.05), back, out])
    effort = OneWayLoad("rod", load=4000.0, travel=0.002).hold(path)
    np.testing.assert_allclose(effort[2:51], 4000.0)
    np.testing.assert_allclose(effort[51:71], 4000.0)
    np.testing.assert_allclose(effort[73:122], 0.0, atol=1e-9)
    np.testing.assert_allclose(effort[125:], 4000.0)


def test_a_load_of_the_other_sign_resists_the_other_way():
    path = np.concatenate([np.linspace(0.0, 0.05, 51), np.linspace(0.05, 0.0, 51)])
    effort = OneWayLoad("rod", load=-4000.0, travel=0.002).hold(path)
    np.testing.assert_allclose(effort[2:51], 0.0, atol=1e-9)
    np.testing.assert_allclose(effort[55:], -4000.0)


def test_regularized_friction_is_viscous_where_slow_and_dry_where_fast():
    effect = RegularizedFriction("a", level=2.0, transition=0.5)
    speed = np.array([-50.0, -1e-3, 0.0, 1e-3, 50.0])
    np.testing.assert_allclose(effect.resist(speed, 1e-4), [-2.0, -4e-3, 0.0, 4e-3, 2.0], rtol=1e-5)
    sharp = RegularizedFriction("a", level=2.0)
    np.testing.assert_allclose(sharp.resist(speed, 1e-6), [-2.0, -2.0, 0.0, 2.0, 2.0])


def test_the_spring_that_a_held_step_shows_is_well_within_its_range():
    """At rest it takes the whole effort at the travel; that was the end of its range."""
    (stiffness,) = JointSpring.magnitudes_at(Place(Element.JOINT, "a", effort=2.0, travel=0.5))
    assert stiffness.largest == 2.0 * 2.0 / 0.5
