"""A clock whose unit nobody says is in the likeliest one that machines are recorded by."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.clock.clock_fields import clock_fields
from ves_twin.data.formats.log import Column, Kind


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


@pytest.mark.parametrize(("name", "unit"), [("ms", "ms"), ("millis", "ms"), ("micros", "us")])
def test_a_column_called_as_a_unit_of_time_is_a_clock_behind_a_text_of_hours(name, unit):
    """`hora;ms;SP_mm;Y_mm` was refused: no column that rises like a time among ms, SP_mm, ..."""
    columns = [Column("hora", "", Kind.TEXT), Column(name, ""), Column("y", "mm")]
    stamps = 100.0 * np.arange(200) + np.random.default_rng(0).integers(0, 3, 200)
    y = np.sin(0.1 * np.arange(200))
    (field,) = clock_fields(columns, {name: stamps, "y": y})
    assert (field.column, field.unit, field.guessed) == (name, unit, False)


def test_a_column_that_rises_and_is_called_like_nothing_is_a_clock_behind_a_text():
    columns = [Column("date", "", Kind.TEXT), Column("a", ""), Column("y", "mm")]
    block = {"a": 0.01 * np.arange(200), "y": np.sin(0.1 * np.arange(200))}
    assert [field.column for field in clock_fields(columns, block)] == ["a"]
