"""Friction that depends on where a joint stands: it turns round with the speed, and needs both."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.diagnosis.law.rubbing import rubbings
from ves_twin.diagnosis.model.law_forward import LawPlace, Variable
from ves_twin.effects.law import LawKind

POSITION, SPEED = Variable("position@rail", "m"), Variable("speed@rail", "m/s")
RAIL = LawPlace("rail", LawKind.EFFORT, "N", 1.0, (POSITION, SPEED))
ENDS = {"position@rail": (-0.2, 0.3), "speed@rail": (-1.0, 2.0)}


def test_a_friction_of_position_has_the_sign_of_the_speed_and_no_other_part_of_it():
    (rubbing,) = rubbings([RAIL], ENDS)
    law = rubbing.law(np.arange(len(rubbing.knots), dtype=float))
    at = np.array(rubbing.knots)
    for speed in (0.1, 0.5, 2.0):
        ahead, back = (law.at(at, np.full(len(at), v)) for v in (speed, -speed))
        assert ahead == pytest.approx(np.arange(len(at)))
        assert back == pytest.approx(-ahead)
    assert law.at(at, np.zeros(len(at))) == pytest.approx(0.0)


@pytest.mark.parametrize(
    "ends",
    [
        {**ENDS, "speed@rail": (0.0, 2.0)},
        {**ENDS, "position@rail": (0.1, 0.1)},
        {"position@rail": ENDS["position@rail"]},
    ],
    ids=["moves one way", "stands", "speed unknown"],
)
def test_where_a_joint_does_not_move_both_ways_there_is_none(ends):
    assert rubbings([RAIL], ends) == []


def test_a_column_that_is_read_does_not_rub():
    reading = LawPlace("rail", LawKind.READING, "N", 1.0, (POSITION, SPEED))
    assert rubbings([reading], ENDS) == []
