"""Mass matrix of any chain: against MuJoCo, against kinetic energy, against Appendix G."""

import mujoco
import numpy as np
import pytest
from appendix_g import appendix_g_mass_matrix

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.plant.assembly import assemble_free_arm, compile_model
from ves_twin.plant.puma_chain import PRINTED_INERTIA

MUJOCO = 1e-8
"""Asked; entries go up to 200, both sides are round-off of double precision."""
ROUND_OFF = 1e-11
"""Sums of some dozen products up to 100."""
BASE_ORDER = np.array([0, 1, 2, 5, 4, 3])
"""MuJoCo's base joints are x y z rz ry rx; ours end in rx ry rz."""


def tip_at(chain, q):
    """End of the last link [m] (..., 3)."""
    rotation, shift = chain.displacements(q)
    return rotation[..., -1, :, :] @ chain.tip + shift[..., -1, :]


def full_mass(model, data):
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    order = np.concatenate([BASE_ORDER, np.arange(6, model.nv)])
    return full[np.ix_(order, order)]


def free_chain_model(chain):
    """The chain as nested MuJoCo bodies on three slides and three hinges."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = [0.0, 0.0, 0.0]
    body = spec.worldbody.add_body(name="base")
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for kind, axis in ((slide, 0), (slide, 1), (slide, 2), (hinge, 2), (hinge, 1), (hinge, 0)):
        body.add_joint(type=kind, axis=np.eye(3)[axis])
    for k in range(chain.joints + 1):
        if k:
            body = body.add_body()
            body.add_joint(
                type=hinge,
                axis=chain.axes[k - 1],
                pos=chain.points[k - 1],
                armature=chain.armature[k - 1],
            )
        body.mass = chain.mass[k]
        body.ipos = chain.com[k]
        i = chain.inertia[k]
        body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
    return spec.compile()


def test_the_puma_has_mujoco_s_mass_matrix(plant, puma):
    model = compile_model(assemble_free_arm(plant))
    data = mujoco.MjData(model)
    for q in np.random.default_rng(1).uniform(-3, 3, (10, 3)):
        data.qpos[:] = 0.0
        data.qpos[6:] = q
        mujoco.mj_forward(model, data)
        assert np.max(np.abs(full_mass(model, data) - puma.mass_matrix(q))) < MUJOCO


@pytest.mark.parametrize("n", [1, 3, 6])
def test_any_chain_has_mujoco_s_mass_matrix(n, random_chain):
    rng = np.random.default_rng(n)
    for _ in range(3):
        chain = random_chain(rng, n)
        model = free_chain_model(chain)
        data = mujoco.MjData(model)
        q = rng.uniform(-3, 3, n)
        data.qpos[6:] = q
        mujoco.mj_forward(model, data)
        scale = np.max(np.abs(chain.mass_matrix(q)))
        assert np.max(np.abs(full_mass(model, data) - chain.mass_matrix(q))) < MUJOCO * scale


def test_appendix_g_with_its_errata_is_the_general_form(plant, printed_puma):
    table = plant.parameters
    for q in np.random.default_rng(2).uniform(-3, 3, (10, 3)):
        ours = appendix_g_mass_matrix(
            plant.arm, table.array("arm.mass"), table.array("arm.com"), PRINTED_INERTIA, q
        )
        assert np.max(np.abs(ours - printed_puma.mass_matrix(q))) < ROUND_OFF


def test_the_printed_slips_of_appendix_g_cost_up_to_the_base_link_s_spin(plant, printed_puma):
    """1.815 kg m^2, which is I0z (errata E-35)."""
    table = plant.parameters
    worst = 0.0
    for q in np.random.default_rng(3).uniform(-2, 2, (20, 3)):
        printed = appendix_g_mass_matrix(
            plant.arm, table.array("arm.mass"), table.array("arm.com"), PRINTED_INERTIA, q, True
        )
        worst = max(worst, np.max(np.abs(printed - printed_puma.mass_matrix(q))))
    assert abs(worst - 1.815) < 0.0005


def test_printed_inertias_are_the_plant_s_with_the_rotors_inside(plant):
    split, rotors = plant.parameters.array("arm.inertia"), plant.parameters.array("arm.armature")
    split[2:, 2] += rotors[1:]
    split[3, 0] = 0.015  # 0.020 in the plant, for the triangle inequality
    np.testing.assert_allclose(PRINTED_INERTIA, split, rtol=1e-12)


def test_the_chain_is_where_the_kinematics_of_the_puma_say(plant, puma):
    q = np.array([0.4, -0.7, 1.3])
    np.testing.assert_allclose(tip_at(puma, q), plant.arm.tip(q), rtol=0, atol=1e-12)
    points, directions = plant.arm.axes(q)
    ours, axes = puma.axes_at(q)
    np.testing.assert_allclose(axes, directions, rtol=0, atol=1e-12)
    apart = np.cross(ours - points, directions)  # the points may differ along the axis
    np.testing.assert_allclose(apart, 0.0, rtol=0, atol=1e-12)


def test_many_configurations_at_once_are_the_same_as_one_by_one(puma):
    q = np.random.default_rng(4).uniform(-3, 3, (4, 5, 3))
    together = puma.mass_matrix(q)
    assert together.shape == (4, 5, 9, 9)
    for i in range(4):
        np.testing.assert_allclose(together[i, 2], puma.mass_matrix(q[i, 2]), rtol=0, atol=1e-12)


def test_chains_that_cannot_be_are_refused(puma):
    with pytest.raises(InvalidInputError, match="unit vectors"):
        SerialChain(
            puma.points, 2 * puma.axes, puma.mass, puma.com, puma.inertia, puma.armature, puma.tip
        )
    with pytest.raises(InvalidInputError, match=r"chain mass: got 'shape \(3,\)'"):
        SerialChain(
            puma.points, puma.axes, puma.mass[1:], puma.com, puma.inertia, puma.armature, puma.tip
        )
    with pytest.raises(InvalidInputError, match="3 in the last place"):
        puma.mass_matrix(np.zeros(4))


def test_a_table_with_a_slide_is_refused():
    chain = DhChain((Joint(0.3, 0.0, 0.0, prismatic=True),), np.eye(4))
    with pytest.raises(InvalidInputError, match="prismatic"):
        SerialChain.of(chain, np.ones(2), np.zeros((2, 3)), np.zeros((2, 3, 3)), np.zeros(1))
