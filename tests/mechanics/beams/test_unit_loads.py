"""Compliance: closed forms against virtual work, and virtual work against other integrals."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.beams.beam import BentBeam, StraightBeam
from ves_twin.mechanics.beams.formulas import bent_compliance, straight_compliance
from ves_twin.mechanics.beams.section import Material, Tube
from ves_twin.mechanics.beams.unit_loads import unit_load_compliance

TUBE = Tube(0.09, 0.007, Material(70e9, 26e9, 2700.0))
UNIT_LOADS = 1e-7
"""Relative to the largest entry: asked of the closed forms; Gauss points are exact here."""
ODE = 1e-8
"""The integrator's relative tolerance is 1e-11 over a compliance of one magnitude."""


def relative(found, expected):
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    return np.max(np.abs(found - expected) / scale)


@pytest.mark.parametrize("direction", [(0, 0, 1), (-1, 0, 0), (1, 0, 0), (0.3, -2.0, 0.7)])
@pytest.mark.parametrize("length", [0.5, 12.0])
def test_a_straight_beam_of_any_orientation_agrees_with_unit_loads(direction, length):
    points = StraightBeam(length, TUBE, direction).points
    closed = straight_compliance(length, TUBE, np.array(direction, float))
    assert relative(closed, unit_load_compliance(points, TUBE)) < UNIT_LOADS


@pytest.mark.parametrize(("l1", "l2"), [(8.0, 8.0), (3.0, 5.0), (10.0, 0.7), (0.2, 6.0)])
def test_a_bent_beam_of_any_lengths_agrees_with_unit_loads(l1, l2):
    closed = bent_compliance(l1, l2, TUBE)
    assert relative(closed, unit_load_compliance(BentBeam(l1, l2, TUBE).points, TUBE)) < UNIT_LOADS


def test_only_the_printed_q55_fails_the_unit_loads():
    exact = unit_load_compliance(BentBeam(8.0, 8.0, TUBE).points, TUBE)
    wrong = np.abs(bent_compliance(8.0, 8.0, TUBE, printed=True) - exact) > 1e-6 * np.abs(exact)
    assert np.argwhere(wrong & (np.abs(exact) > 1e-12)).tolist() == [[4, 4]]


def test_unit_loads_agree_with_the_differential_equation_of_the_beam():
    """Integrates EI theta' = M, u' = theta x e along a bent line; knows no virtual work."""
    points = np.array([[1.0, 2.0, 0.0], [3.0, 2.5, 1.0], [3.0, 5.0, 2.0], [6.0, 5.0, 2.5]])
    tip, wrench = points[-1], np.array([3.0, -2.0, 1.0, 4.0, 5.0, -6.0])
    displacement, rotation = np.zeros(3), np.zeros(3)
    for start, end in itertools.pairwise(points):
        length = np.linalg.norm(end - start)
        axis = (end - start) / length

        def slope(s, y, start=start, axis=axis):
            moment = wrench[3:] + np.cross(tip - (start + s * axis), wrench[:3])
            along = axis * (axis @ moment)
            strain = axis * (axis @ wrench[:3]) / TUBE.axial
            return np.concatenate(
                [
                    np.cross(y[3:], axis) + strain,
                    along / TUBE.torsion + (moment - along) / TUBE.bending,
                ]
            )

        state = np.concatenate([displacement, rotation])
        state = solve_ivp(slope, (0, length), state, rtol=1e-11, atol=1e-15).y[:, -1]
        displacement, rotation = state[:3], state[3:]
    found = unit_load_compliance(points, TUBE) @ wrench
    expected = np.concatenate([displacement, rotation])
    assert np.max(np.abs(found - expected)) < ODE * np.max(np.abs(expected))


def test_compliance_is_symmetric_and_positive():
    compliance = unit_load_compliance(np.array([[0, 0, 0], [1, 2, 3], [2, 2, 1.0]]), TUBE)
    np.testing.assert_allclose(compliance, compliance.T, rtol=0, atol=1e-18)
    assert np.min(np.linalg.eigvalsh(compliance)) > 0


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Tube(0.09, 0.05), ["wall", "0.05", "0.045 m"]),
        (lambda: Tube(-0.09, 0.005), ["outer_diameter", "above zero"]),
        (lambda: Material(float("nan"), 1.0, 1.0), ["elasticity", "finite"]),
        (lambda: StraightBeam(0.0, TUBE), ["length", "above zero"]),
        (lambda: StraightBeam(1.0, TUBE, (0.0, 0.0, 0.0)), ["direction", "not all zero"]),
        (lambda: BentBeam(8.0, -1.0, TUBE), ["l2", "above zero"]),
        (lambda: unit_load_compliance(np.zeros((2, 3)), TUBE), ["points", "different"]),
        (lambda: unit_load_compliance(np.zeros((1, 3)), TUBE), ["points", "two or more"]),
    ],
)
def test_a_beam_that_cannot_be_is_refused_in_one_line(build, words):
    with pytest.raises(InvalidInputError) as caught:
        build()
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)
