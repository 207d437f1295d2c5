"""Virtual manipulators: printed lengths, and the conservation of the centre of mass."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.planning.virtual_manipulator import VirtualManipulator

LENGTHS = 0.001
"""1 mm, as the claim asks of the corrected lengths."""


def in_link_frames(plant, virtual):
    rotation = np.concatenate([np.eye(3)[None], plant.arm.transforms(np.zeros(3))[:, :3, :3]])
    return np.einsum("kij,ki->kj", rotation, virtual.links)


def test_lengths_to_the_endpoint_are_those_of_the_corrected_appendix_b(plant, puma):
    """B.5 with 93.7 kg and R1 = d1 - r0z = 0.389 (E-41); 0.001 of y was dropped in print."""
    expected = [[0, 0, 0.226], [0, 0, -0.1672], [0.377, 0.0011, 0.0855], [0.405, 0, 0]]
    found = in_link_frames(plant, VirtualManipulator.to_endpoint(puma))
    np.testing.assert_allclose(found, expected, rtol=0, atol=LENGTHS)


def test_lengths_to_the_base_are_those_of_the_corrected_appendix_b(plant, puma):
    """B.6; only V1 differs from print, -0.163 for -0.263 (E-41)."""
    expected = [[0, 0, -0.163], [0, 0, 0.0763], [-0.054, 0.0011, -0.0125], [-0.0280, 0, 0]]
    found = in_link_frames(plant, VirtualManipulator.to_base(puma))
    np.testing.assert_allclose(found, expected, rtol=0, atol=LENGTHS)


@pytest.mark.parametrize("n", [1, 3, 6])
def test_reach_goes_from_the_centre_of_mass_to_the_point(n, random_chain):
    rng = np.random.default_rng(n)
    chain = random_chain(rng, n)
    q = rng.uniform(-3, 3, (5, n))
    total = chain.coms_at(q) * chain.mass[:, None]
    centre = total.sum(axis=1) / chain.mass.sum()
    end, base = VirtualManipulator.to_endpoint(chain), VirtualManipulator.to_base(chain)
    rotation, shift = chain.displacements(q)
    tip = rotation[:, -1] @ chain.tip + shift[:, -1]
    np.testing.assert_allclose(centre + end.reach(q), tip, rtol=0, atol=1e-12)
    np.testing.assert_allclose(centre + base.reach(q), np.tile(chain.com[0], (5, 1)), atol=1e-12)


def test_the_base_s_jacobian_is_what_momentum_gives(puma):
    """A free base that does not turn moves by -H_vq q' / M."""
    q = np.array([0.5, -0.4, 0.9])
    virtual = VirtualManipulator.to_base(puma)
    expected = -puma.mass_matrix(q)[:3, 6:] / puma.mass.sum()
    np.testing.assert_allclose(virtual.jacobian(q), expected, rtol=0, atol=1e-12)


def test_the_jacobian_is_the_derivative_of_the_reach(random_chain):
    rng = np.random.default_rng(8)
    chain = random_chain(rng, 4)
    q, h = rng.uniform(-2, 2, 4), 1e-6
    virtual = VirtualManipulator.to(chain, rng.normal(size=3), 2)
    numeric = np.column_stack(
        [(virtual.reach(q + h * e) - virtual.reach(q - h * e)) / (2 * h) for e in np.eye(4)]
    )
    np.testing.assert_allclose(virtual.jacobian(q), numeric, rtol=0, atol=1e-8)


def test_joint_gains_do_the_work_of_the_wanted_spring(puma):
    """dq' K_vm dq is the energy of K_d over the point's displacement; eqs 4.1 and 4.2."""
    q, step = np.array([0.3, 0.6, -0.2]), np.array([1e-3, -2e-3, 1.5e-3])
    virtual = VirtualManipulator.to_base(puma)
    wanted, damping = np.diag([900.0, 400.0, 1500.0]), np.diag([30.0, 20.0, 50.0])
    gains = virtual.joint_gains(wanted, damping, q)
    moved = virtual.jacobian(q) @ step
    np.testing.assert_allclose(step @ gains.stiffness @ step, moved @ wanted @ moved, rtol=1e-12)
    np.testing.assert_allclose(step @ gains.damping @ step, moved @ damping @ moved, rtol=1e-12)


def test_a_link_that_is_not_there_is_refused(puma):
    with pytest.raises(InvalidInputError, match="0 to 3"):
        VirtualManipulator.to(puma, np.zeros(3), 4)
