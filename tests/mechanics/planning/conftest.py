"""The PUMA of the nominal plant as a chain, and the bent beam to the letter of the thesis."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.plant.puma_chain import puma_chain


@pytest.fixture(scope="session")
def plant():
    return vt.Plant.load("ves2")


@pytest.fixture(scope="session")
def puma(plant):
    return puma_chain(plant)


@pytest.fixture(scope="session")
def printed_puma(plant):
    return puma_chain(plant, printed=True)


@pytest.fixture(scope="session")
def pped_pose():
    """Thesis 4.3.2."""
    return np.radians([45.0, 0.0, 0.0])


@pytest.fixture(scope="session")
def bent():
    return EmulatedSystem.load("beam_bent_printed")


@pytest.fixture(scope="session")
def random_chain():
    """Makes an arm of n joints in general position."""
    return _random_chain


def _random_chain(rng, n):
    axes = rng.normal(size=(n, 3))
    inertia = np.empty((n + 1, 3, 3))
    for k in range(n + 1):
        spread = rng.normal(size=(4, 3))  # four point masses: a possible body
        inertia[k] = np.sum(spread**2) * np.eye(3) - spread.T @ spread
    return SerialChain(
        points=rng.normal(size=(n, 3)),
        axes=axes / np.linalg.norm(axes, axis=1)[:, None],
        mass=rng.uniform(1.0, 20.0, n + 1),
        com=rng.normal(size=(n + 1, 3)),
        inertia=inertia,
        armature=rng.uniform(0.0, 2.0, n),
        tip=rng.normal(size=3),
    )
