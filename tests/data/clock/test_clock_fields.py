"""A clock whose unit nobody says is in the likeliest one that machines are recorded by."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.clock.clock_fields import clock_fields
from ves_twin.data.formats.log import Column


@pytest.mark.parametrize(
    ("step", "unit"), [(0.00667, "s"), (6.67, "ms"), (5.0, "ms"), (5000.0, "us"), (1234.5, "us")]
)
def test_the_first_unit_is_taken_in_which_rows_are_as_far_apart_as_usual(step, unit):
    time = 0.31 * step * (step % 1.0 > 0.0) + step * np.arange(200)
    (field,) = clock_fields([Column("time", "")], {"time": time})
    assert (field.unit, field.guessed) == (unit, True)


def test_rows_that_are_far_apart_in_every_unit_are_in_seconds():
    time = 4e6 * np.arange(200) + 0.5
    (field,) = clock_fields([Column("time", "")], {"time": time})
    assert field.unit == "s"
