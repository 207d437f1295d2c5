"""Coupling: what Q means, maps, paths and the motion they cause."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import Coupling, EmulatedSystem
from ves_twin.mechanics.joint_motion import quintic
from ves_twin.mechanics.planning.base_motion import base_motion
from ves_twin.mechanics.planning.coupling import coupling_length, coupling_matrix
from ves_twin.mechanics.planning.coupling_map import coupling_map
from ves_twin.mechanics.planning.flexible_base import strain_energy
from ves_twin.mechanics.planning.hot_spot import hot_spot_path
from ves_twin.mechanics.planning.timed_path import evenly, rounded, timed_path

RIGHT = np.pi / 2
START, END = np.array([0.0, RIGHT, 0.0]), np.array([RIGHT, 0.0, 0.0])
CORNER = np.array([0.0, 0.0, 0.0])
"""Lowering the arm before it turns: the bad path's corner."""


@pytest.fixture(scope="module")
def beam():
    return EmulatedSystem.load("beam_bent_thesis")


def momentum_matrix(chain, base, q):
    """Of motion faster than the base, over before the springs act: E = 1/2 dq Q dq, Q = D' K D,
    D = (M + H_bb)^-1 H_bq [J/rad^2]."""
    arm = chain.mass_matrix(q)
    step = np.linalg.solve(arm[..., :6, :6] + base.mass, arm[..., :6, 6:])
    return np.swapaxes(step, -1, -2) @ base.stiffness @ step


def momentum_length(chain, base, path):
    """`coupling_length` with that matrix."""
    steps, q = np.diff(path, axis=0), momentum_matrix(chain, base, (path[1:] + path[:-1]) / 2)
    return np.sum(np.sqrt(np.einsum("ki,kij,kj->k", steps, q, steps)))


def moved(path, seconds, period=0.01):
    return timed_path(path, seconds, period, rest=10.0)


def small_motion(q, direction, seconds, period):
    """A smooth little move there and back; its acceleration is known."""
    t = np.arange(0.0, seconds, period)
    shape = 1e-3 * np.sin(np.pi * t / seconds) ** 4
    return t, q + shape[:, None] * direction, np.gradient(np.gradient(shape, t), t)


def test_slow_motion_stores_half_q_times_acceleration_squared(puma, beam):
    """Ten times slower than the base: the quasi-static energy, to 4 % of the peak."""
    q, direction = np.array([0.3, 0.5, -0.4]), np.array([0.6, -0.5, 0.62])
    t, path, acceleration = small_motion(q, direction, 400.0, 0.1)
    energy = strain_energy(beam, base_motion(puma, beam, path, 0.1))
    matrix = coupling_matrix(puma, beam, q)
    expected = 0.5 * acceleration**2 * (direction @ matrix @ direction)
    assert np.max(np.abs(energy - expected)) < 0.04 * np.max(expected)
    assert len(t) == len(energy)


def test_fast_motion_stores_half_q_times_step_squared(puma, beam):
    """A move in a hundredth of the fastest period of the base; momentum is kept."""
    q, direction = np.array([0.3, 0.5, -0.4]), np.array([0.6, -0.5, 0.62])
    step = np.array([quintic(s) for s in np.linspace(0.0, 1.0, 201)])
    path = q + 1e-3 * step[:, None] * direction
    energy = strain_energy(beam, base_motion(puma, beam, path, 0.01 / 200))[-1]
    matrix = momentum_matrix(puma, beam, q)
    # springs and dampers act for 10 ms; the coupling changes along 1 mrad
    np.testing.assert_allclose(energy, 0.5e-6 * direction @ matrix @ direction, rtol=0.02)


def test_base_motion_converges_in_its_period(puma, beam):
    path = evenly(np.array([START, END]), 101)
    ends = [base_motion(puma, beam, moved(path, 5.0, h), h)[-1] for h in (0.02, 0.01, 0.005)]
    coarse, fine = (np.linalg.norm(ends[i] - ends[i + 1]) for i in (0, 1))
    assert coarse / fine > 3.5  # second order


def test_a_free_base_keeps_its_momentum(puma):
    base = EmulatedSystem(
        "free", Coupling.COUPLED, np.eye(6) * 1e-6, np.zeros((6, 6)), np.zeros((6, 6)), ""
    )
    q = evenly(np.array([[0.0, 0.2, 0.1], [0.0, 0.205, 0.1]]), 101)
    moves = base_motion(puma, base, q, 0.01)
    centres = np.einsum("k,nkj->nj", puma.mass, puma.coms_at(q)) / puma.mass.sum()
    turn = np.cross(moves[:, 3:], centres)
    shift = centres + moves[:, :3] + turn - centres[0]
    # the base turns by 0.8 mrad while the centre moves by 0.4 mm: their product is left
    assert np.max(np.abs(shift)) < 1e-6
    assert np.linalg.norm(centres[-1] - centres[0]) > 3e-4


def test_a_map_has_the_eigenvectors_of_its_matrices(puma, beam):
    angles = np.linspace(0.0, RIGHT, 12)
    found = coupling_map(puma, beam, (0, 2), angles, angles, np.array([0.0, 0.4, 0.0]))
    assert found.most.shape == (12, 12)
    q = np.array([angles[3], 0.4, angles[7]])
    matrix = coupling_matrix(puma, beam, q)[np.ix_([0, 2], [0, 2])]
    np.testing.assert_allclose(found.matrix[3, 7], matrix, rtol=1e-12, atol=1e-14)
    low = found.low[3, 7]
    np.testing.assert_allclose(matrix @ low, found.least[3, 7] ** 2 * low, atol=1e-12)
    assert np.all(found.least <= found.most)
    assert np.all(found.low[..., 0] >= 0)


def test_lines_run_along_the_least_energy(puma, beam):
    angles = np.linspace(0.0, RIGHT, 40)
    found = coupling_map(puma, beam, (0, 1), angles, angles, np.zeros(3))
    line = found.line(np.array([0.7, 0.7]), 0.02)
    assert np.all((line >= -1e-12) & (line <= RIGHT + 1e-12))
    ends = np.minimum(line, RIGHT - line).min(axis=1)
    assert ends[0] < 0.03  # it goes from edge to edge
    assert ends[-1] < 0.03
    full = np.zeros((len(line), 3))
    full[:, :2] = line
    across = np.column_stack([-np.diff(line[:, 1]), np.diff(line[:, 0])])
    middles = coupling_matrix(puma, beam, (full[1:] + full[:-1]) / 2)[:, :2, :2]
    along = np.einsum("ki,kij,kj->k", np.diff(line, axis=0), middles, np.diff(line, axis=0))
    sideways = np.einsum("ki,kij,kj->k", across, middles, across)
    assert np.all(along < sideways)


def test_lines_of_the_faces_with_joint_1_stand_up(puma, beam):
    """C059: nearly vertical, joint 1 drawn along x, on the face of joints 1 and 3; on the face of
    joints 1 and 2 only while the arm is stretched out and low."""
    angles = np.linspace(0.0, RIGHT, 30)
    for joints, held in (((0, 2), 0.0), ((0, 1), 0.0)):
        found = coupling_map(puma, beam, joints, angles, angles, np.full(3, held))
        tilt = np.degrees(np.arctan2(found.low[..., 0], np.abs(found.low[..., 1])))
        part = tilt if joints == (0, 2) else tilt[:, angles < np.radians(30)]
        assert np.median(part) < 20.0


@pytest.mark.parametrize("free", [(0, 1), (0, 1, 2)])
def test_the_planned_path_transfers_far_less_energy_than_the_bad_one(puma, beam, free):
    low, high = START.copy(), START.copy()
    low[list(free)], high[list(free)] = -0.5, RIGHT + 0.5
    low[2], high[2] = (0.0, 0.0) if free == (0, 1) else (-0.5, 0.5)
    good = hot_spot_path(puma, beam, START, END, low, high, cells=24)
    np.testing.assert_array_equal(good[[0, -1]], [START, END])
    bad = rounded(np.array([START, CORNER, END]))
    assert coupling_length(puma, beam, good) < 0.5 * coupling_length(puma, beam, bad)
    both = np.array([moved(good, 5.0), moved(bad, 5.0)])
    peaks = strain_energy(beam, base_motion(puma, beam, both, 0.01)).max(axis=1)
    assert peaks[0] < 0.5 * peaks[1]


def test_a_rounded_path_keeps_its_ends_and_turns_gently():
    path = rounded(np.array([START, CORNER, END]))
    np.testing.assert_array_equal(path[[0, -1]], [START, END])
    steps = np.diff(path, axis=0)
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    turns = np.degrees(np.arccos(np.clip(np.sum(steps[1:] * steps[:-1], axis=1), -1, 1)))
    # 90 deg of a Gaussian of 16 points: 2.2 deg a point, twice that once they are spaced evenly
    assert turns.max() < 5.0
    assert np.min(np.linalg.norm(path - CORNER, axis=1)) < np.radians(6.0)
    assert np.all(path[:, 0] > -1e-3)  # no wiggle at the ends
    assert np.all(path[:, 1] > -1e-3)


def test_the_coupling_crossed_predicts_the_energy_of_random_moves(puma, beam, figure):
    """40 straight moves of 4 s in the quadrant; nothing in Q knows the dynamics of the base."""
    rng = np.random.default_rng(7)
    ends = rng.uniform(0.0, RIGHT, (40, 2, 3))
    paths = [evenly(pair, 41) for pair in ends]
    poses = base_motion(puma, beam, np.array([moved(path, 4.0, 0.02) for path in paths]), 0.02)
    energy = np.log(strain_energy(beam, poses).max(axis=1))
    correlation = {}
    for form, length in (("compliance", coupling_length), ("momentum", momentum_length)):
        crossed = [np.log(length(puma, beam, path)) for path in paths]
        correlation[form] = float(np.corrcoef(crossed, energy)[0, 1])
        what = f"coupling map ({form}): peak energy of random moves not explained"
        figure(what, 100 * (1 - correlation[form] ** 2), 40.0, "%")
    assert correlation["compliance"] > 0.95


def test_a_timed_path_starts_and_ends_at_rest_on_the_corners():
    path = timed_path(np.array([START, CORNER, END]), 4.0, 0.01, 1.0)
    assert path.shape == (501, 3)
    np.testing.assert_array_equal(path[0], START)
    np.testing.assert_allclose(path[400:], np.tile(END, (101, 1)), rtol=0, atol=1e-12)
    np.testing.assert_allclose(path[200], CORNER, rtol=0, atol=1e-12)  # half the length
    rates = np.linalg.norm(np.diff(path, axis=0), axis=1) / 0.01
    assert rates[0] < 0.01
    # a quintic peaks at 15/8 of the mean rate
    np.testing.assert_allclose(rates.max(), 15 / 8 * np.pi / 4, rtol=0.001)


def test_a_path_without_price_on_coupling_is_straight(puma, beam):
    bounds = np.array([-0.2, -0.2, 0.0]), np.array([RIGHT + 0.2, RIGHT + 0.2, 0.0])
    path = hot_spot_path(puma, beam, START, END, *bounds, cells=30, straightness=1e6)
    straight = evenly(np.array([START, END]), len(path))
    assert np.max(np.abs(path - straight)) < 0.05  # a cell


def test_wrong_questions_are_refused(puma, beam):
    angles = np.linspace(0.0, 1.0, 3)
    with pytest.raises(InvalidInputError, match="two different ones of 1 to 3"):
        coupling_map(puma, beam, (0, 3), angles, angles, np.zeros(3))
    with pytest.raises(InvalidInputError, match="rising"):
        coupling_map(puma, beam, (0, 1), angles[::-1], angles, np.zeros(3))
    with pytest.raises(InvalidInputError, match="path end"):
        hot_spot_path(puma, beam, START, END, np.zeros(3), np.array([1.0, 2.0, 0.0]))
    with pytest.raises(InvalidInputError, match="may move"):
        hot_spot_path(puma, beam, START, START, START, START)
    free = EmulatedSystem("free", Coupling.COUPLED, beam.mass, beam.damping, 0 * beam.mass, "")
    with pytest.raises(InvalidInputError, match="singular"):
        coupling_matrix(puma, free, np.zeros(3))
    with pytest.raises(InvalidInputError, match="two different configurations"):
        timed_path(np.array([START, START]), 1.0, 0.1, 0.0)
    with pytest.raises(InvalidInputError, match="above zero"):
        timed_path(np.array([START, END]), 0.0, 0.1, 0.0)
    with pytest.raises(InvalidInputError, match="three or more rows"):
        base_motion(puma, beam, np.zeros((2, 3)), 0.1)
