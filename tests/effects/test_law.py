"""Laws: what a table, a mesh, a play and a hold make of their variables."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from ves_twin.effects.law import Law, LawKind, LawShape, played


def law(shape: LawShape, knots, values, kind=LawKind.EFFORT, of=("speed@joint",)) -> Law:
    return Law("joint", kind, shape, of, knots, values)


def test_a_table_is_linear_between_its_knots_and_held_beyond_them() -> None:
    drag = law(LawShape.TABLE, ((-1.0, 0.0, 2.0),), (3.0, 0.0, -4.0))
    assert_allclose(drag.at(np.array([-5.0, -0.5, 1.0, 9.0])), [3.0, 1.5, -2.0, -4.0])
    assert drag.beyond(np.array([-5.0, -0.5, 1.0, 9.0])) == 0.5


def test_a_mesh_is_exact_for_a_product_of_its_variables() -> None:
    x, y = (-1.0, 0.5, 2.0), (0.0, 1.0, 3.0)
    values = tuple(a * b for a in x for b in y)
    product = law(LawShape.MESH, (x, y), values, of=("position@joint", "speed@joint"))
    rng = np.random.default_rng(1)
    p, q = rng.uniform(-1.0, 2.0, 50), rng.uniform(0.0, 3.0, 50)
    assert_allclose(product.at(p, q), p * q, atol=1e-12)


def test_a_play_follows_half_a_gap_behind_and_forgets_small_motions() -> None:
    up_and_down = np.array([0.0, 1.0, 0.9, 0.8, 0.0, 0.1])
    assert_allclose(played(up_and_down, 0.4), [0.0, 0.8, 0.8, 0.8, 0.2, 0.2])


def test_a_reading_is_added_to_and_a_hold_repeats_rows() -> None:
    column = np.arange(6.0)
    shifted = law(LawShape.TABLE, ((0.0, 1.0),), (0.0, 2.0), LawKind.READING)
    assert_allclose(shifted.read(column, np.full(6, 0.5)), column + 1.0)
    held = law(LawShape.HOLD, (), (3.0,), LawKind.READING, of=())
    assert_allclose(held.read(column), [0, 0, 0, 3, 3, 3])


@pytest.mark.parametrize("shape", [LawShape.TABLE, LawShape.MESH])
def test_labels_say_place_and_variables(shape: LawShape) -> None:
    assert law(shape, (), ()).label == "joint(speed@joint)"
