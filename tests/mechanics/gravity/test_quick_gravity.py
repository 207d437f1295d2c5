"""The compiled wrench against the general one, for any chain."""

import numpy as np
import pytest

from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.quick_gravity import QuickGravity
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint
from ves_twin.plant.plant import Plant

TURNED = np.array([[0, -1, 0, 0.1], [1, 0, 0, -0.2], [0, 0, 1, 0.3], [0, 0, 0, 1.0]])
CHAINS = {
    "puma": Plant.load("ves2").arm.chain,
    "slide": DhChain(
        (Joint(0.3, 0.1, 0.0), Joint(0.0, 0.4, np.pi), Joint(0.05, 0.0, 0.0, prismatic=True)),
        TURNED,
    ),
    "four": DhChain(
        tuple(Joint(0.1 * k, 0.2, 0.5 * k - 1.0, theta=0.3) for k in range(4)), np.eye(4)
    ),
}


@pytest.mark.parametrize("name", CHAINS)
def test_the_quick_wrench_is_the_general_one(name):
    rng, chain = np.random.default_rng(2), CHAINS[name]
    links = len(chain.joints) + 1
    model = GravityModel.of(chain, rng.uniform(1, 20, links), rng.normal(size=(links, 3)), 9.81)
    quick = QuickGravity.of(model)
    q = rng.uniform(-np.pi, np.pi, (20, links - 1))
    angles = rng.uniform(-0.4, 0.4, (20, 3))
    found = [quick.wrench_in_top(*pair) for pair in zip(q, angles, strict=True)]
    # sums of products of order 1e3 in double precision
    np.testing.assert_allclose(found, model.wrench_in_top(q, angles), rtol=0, atol=1e-10)
