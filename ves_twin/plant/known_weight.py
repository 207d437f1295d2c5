"""hang_weight: a known weight on the end of the forearm."""

from __future__ import annotations

import numpy as np

from ves_twin.plant.plant import Plant


def hang_weight(plant: Plant, mass: float) -> Plant:
    """The plant with a point mass [kg] at O3, the end of the forearm, as part of link 3.

    The common centre moves towards O3, and the reduced mass m3 m / (m3 + m) at the distance d
    between the two adds mu (d^2 1 - d d') to the inertia about it.
    """
    array = plant.parameters.array
    masses, com, inertia = array("arm.mass"), array("arm.com"), array("arm.inertia")
    reduced = masses[3] * mass / (masses[3] + mass)
    inertia[3] += reduced * (np.sum(com[3] ** 2) - com[3] ** 2)
    com[3] *= masses[3] / (masses[3] + mass)
    masses[3] += mass
    return plant.with_values({"arm.mass": masses, "arm.com": com, "arm.inertia": inertia})
