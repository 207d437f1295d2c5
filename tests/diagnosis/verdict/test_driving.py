"""driving: friction that would push its joint on is marked, and no name of it is firm."""

from __future__ import annotations

import pytest

from ves_twin.diagnosis.build_up.result import Proved, Size
from ves_twin.diagnosis.verdict.driving import driving

NONE = {"coulomb_friction@a:level": 0.0, "viscous_friction@a:damping": 0.0}


def proved(effect: str, size: str, value: float, target: str = "a") -> Proved:
    sizes = {size: Size(value, value - 0.1, value + 0.1, "N*m", 0.0)}
    return Proved(effect, target, sizes, 1e-4, 10, {}, True)


@pytest.mark.parametrize(
    ("value", "beside", "nominal", "drives"),
    [
        (-0.3, (), NONE, True),  # torques that were read 0.1 s late, of an arm without friction
        (0.3, (), NONE, False),
        (-0.3, (), {}, False),  # nobody tells what else there is
        (-0.3, (), {**NONE, "viscous_friction@a:damping": 0.5}, False),
        (-0.3, (proved("coulomb_friction", "level", 0.5),), NONE, False),
        (-0.3, (proved("coulomb_friction", "level", 0.5, "b"),), NONE, True),
    ],
)
def test_drag_below_none_needs_another_friction_of_its_joint(value, beside, nominal, drives):
    found = driving([proved("quadratic_drag", "drag", value), *beside], nominal)[0]
    assert found.drives is drives
    assert found.firm is not drives


@pytest.mark.parametrize(("level", "drives"), [(0.1, True), (0.3, False)])
def test_a_difference_by_direction_is_no_more_than_the_friction(level, drives):
    """Of a card that swings dry friction was less than none one way."""
    both = (
        proved("coulomb_asymmetry", "level", -0.2),
        proved("coulomb_friction", "level", level),
    )
    difference, friction = driving(both, NONE)
    assert difference.drives is drives
    assert friction.firm


def test_nothing_is_said_beside_a_friction_of_another_form():
    other = proved("regularized_friction", "level", 0.5)
    found = driving([proved("coulomb_asymmetry", "level", 0.2), other], NONE)
    assert [one.drives for one in found] == [False, False]
