"""A crank's piston follows by the formula of every textbook, in place, speed and acceleration."""

from __future__ import annotations

import numpy as np
import pytest
from test_loops import HOME, MASS, model, place, ratio

from ves_twin.machines.mjcf.parts.loop_motion import LoopMotion


def test_a_piston_follows_its_crank_in_place_speed_and_acceleration():
    """By x(t) of the crank's angle, whose second derivative is taken by central differences."""
    machine = model()
    crank, piston = (machine.joint(name) for name in ("crank", "piston"))
    turns = np.linspace(0.0, 2.0 * np.pi, 40)[:, None]  # more than a turn of one sign, in big steps
    speed, pull = np.full_like(turns, 3.0), np.full_like(turns, -2.0)
    moved = LoopMotion.of(machine, np.array([crank.dofadr[0]]), turns, speed, pull)
    angles, at = HOME + turns[:, 0], int(piston.dofadr[0])
    assert not np.any(moved.open)
    x = np.array([place(angle) for angle in angles]) - place(HOME)
    np.testing.assert_allclose(moved.position[:, piston.qposadr[0]], x, atol=1e-6)
    rate = np.array([ratio(angle) for angle in angles])
    np.testing.assert_allclose(moved.speed[:, at], 3.0 * rate, atol=1e-5)
    bent = np.array([(ratio(a + 1e-5) - ratio(a - 1e-5)) / 2e-5 for a in angles])
    np.testing.assert_allclose(moved.pull[:, at], 9.0 * bent - 2.0 * rate, atol=1e-4)
    felt = moved.at_drives(MASS * np.eye(machine.nv)[np.full(len(turns), at)])
    np.testing.assert_allclose(felt[:, 0], MASS * rate, atol=1e-5)


def test_a_crank_that_turns_several_times_between_two_rows_is_followed():
    """At 15 rad/s and a row in 0.4 s: a minute of it was told to come apart."""
    machine = model()
    crank, piston = (machine.joint(name) for name in ("crank", "piston"))
    turns = np.linspace(50.0, 950.0, 150)[:, None]
    still = np.zeros_like(turns)
    moved = LoopMotion.of(machine, np.array([crank.dofadr[0]]), turns, still, still)
    assert not np.any(moved.open)
    x = np.array([place(HOME + angle) for angle in turns[:, 0]]) - place(HOME)
    np.testing.assert_allclose(moved.position[:, piston.qposadr[0]], x, atol=1e-6)
    np.testing.assert_allclose(moved.position[:, crank.qposadr[0]], turns[:, 0])


def test_a_row_beyond_the_reach_is_open_and_those_beside_it_are_not():
    machine = model("piston")
    piston = machine.joint("piston")
    x = np.linspace(0.0, 0.05, 50)[:, None]
    x[20] = 1.0
    drives = np.array([piston.dofadr[0]])
    moved = LoopMotion.of(machine, drives, x, np.ones_like(x), np.zeros_like(x))
    assert list(np.flatnonzero(moved.open)) == [20]
    np.testing.assert_allclose(moved.speed[~moved.open, piston.dofadr[0]], 1.0)


@pytest.mark.parametrize("far", [0.5, -1.0])
def test_rows_beyond_the_reach_are_open_and_at_rest(far):
    machine = model("piston")
    piston = machine.joint("piston")
    x = np.linspace(0.0, far, 50)[:, None]
    drives = np.array([piston.dofadr[0]])
    moved = LoopMotion.of(machine, drives, x, np.ones_like(x), np.zeros_like(x))
    assert moved.open.all()  # most of it, so that no further row is tried
    assert not np.any(moved.speed)
