"""A formula of columns: what it gives, which columns it needs, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.data.mapping.column_expression import ColumnExpression

COLUMNS = {"f1": np.array([1.0, 2.0]), "f2": np.array([4.0, 8.0]), "x [mm]": np.array([3.0, 0.0])}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("f2 - f1", [3.0, 6.0]),
        ("-2.5e1 * (f1 + f2) / 5", [-25.0, -50.0]),
        ("+f1", [1.0, 2.0]),
        ("0.001 * `x [mm]`", [0.003, 0.0]),
    ],
)
def test_it_is_computed_as_it_is_written(text, values):
    assert ColumnExpression(text).value(COLUMNS) == pytest.approx(np.array(values))


def test_it_names_each_column_once_as_the_log_does():
    assert ColumnExpression("f1 * f1 - `x [mm]` / f2").columns == ("f1", "x [mm]", "f2")


def test_a_division_by_zero_is_no_number():
    assert not np.isfinite(ColumnExpression("f1 / `x [mm]`").value(COLUMNS)[1])


@pytest.mark.parametrize(
    "text", ["f1 +", "f1 ** 2", "open('x')", "f1.real", "f1[0]", "f1 if f2 else 1", "'f1' * 2", ""]
)
def test_anything_else_is_refused_in_one_line(text):
    with pytest.raises(InvalidInputError, match="formula of columns") as caught:
        _ = ColumnExpression(text).columns
    assert "\n" not in str(caught.value)
