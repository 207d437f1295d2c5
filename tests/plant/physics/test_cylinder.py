"""The oil column: a spring and a damper whose rest length the valve integrates."""

import numpy as np
import pytest

from ves_twin.plant.physics import cylinder

ROUND_OFF = 1e-12
"""Relative; sums of two products."""
STEP = 341e-6
RNG = np.random.default_rng(9)
SPOOL, SLIDE, SPEED, COLUMN = RNG.uniform(-1, 1, (4, 6)) * [[1.0], [0.2], [0.5], [0.2]]


@pytest.fixture
def blocks():
    p, s = np.zeros(1, cylinder.PARAMETERS), np.zeros(1, cylinder.STATE)
    p["full_speed"], p["stiffness"], p["damping"] = 0.5, 1e7, 2e4
    s["column"] = COLUMN
    return p, s


def test_the_force_is_that_of_the_column_before_it_moves(blocks):
    p, s = blocks
    force = np.zeros(6)
    cylinder.push_rods(p[0], s[0], force, SPOOL, SLIDE, SPEED, STEP)
    expected = 1e7 * (COLUMN - SLIDE) - 2e4 * SPEED
    np.testing.assert_allclose(force, expected, rtol=ROUND_OFF)


def test_the_column_moves_by_the_flow_of_the_mean_opening(blocks):
    p, s = blocks
    force = np.zeros(6)
    for _ in range(100):
        cylinder.push_rods(p[0], s[0], force, SPOOL, SLIDE, SPEED, STEP)
    np.testing.assert_allclose(s["column"][0], COLUMN + 100 * 0.5 * SPOOL * STEP, rtol=ROUND_OFF)


def test_at_full_opening_an_unloaded_rod_runs_at_full_speed(blocks):
    p, s = blocks
    force = np.zeros(6)
    before = s["column"][0].copy()
    for _ in range(1000):
        cylinder.push_rods(p[0], s[0], force, np.ones(6), SLIDE, SPEED, 1e-3)
    np.testing.assert_allclose(s["column"][0] - before, 0.5, rtol=1e-10)


def test_a_rod_at_the_column_with_a_closed_valve_feels_nothing(blocks):
    p, s = blocks
    force = np.zeros(6)
    cylinder.push_rods(p[0], s[0], force, np.zeros(6), COLUMN, np.zeros(6), STEP)
    np.testing.assert_array_equal(force, 0.0)
    np.testing.assert_array_equal(s["column"][0], COLUMN)
