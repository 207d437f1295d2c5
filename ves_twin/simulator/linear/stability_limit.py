"""stability_limit: the lightest model that the emulation of one axis carries."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.admittance_loop import AxisModel, admittance_loop, payload_mass
from ves_twin.simulator.linear.leg_settings import LegSettings


def stability_limit(
    plant: Plant, settings: LegSettings, rate: float, lowest: float = 0.02, highest: float = 4.0
) -> float:
    """Least mass of the trial model, over the payload's, above which the axis is stable.

    Searched from above, so that a stable island below an unstable range does not count.

    Args:
        plant: numbers.
        settings: the leg loops.
        rate: admittance cycles [Hz].
        lowest: smallest ratio tried; returned where all are stable.
        highest: largest ratio tried; infinity is returned where it is unstable already.

    Source: thesis 5.4 (half the payload mass with the filter on the error).
    """
    from scipy.optimize import brentq  # slow to import

    payload = payload_mass(plant)

    def growth(ratio: float) -> float:
        return admittance_loop(plant, settings, AxisModel.trial(ratio * payload), rate).growth

    ratios = np.geomspace(highest, lowest, 24)
    if growth(highest) >= 0.0:
        return float("inf")
    for above, ratio in pairwise(ratios):
        if growth(float(ratio)) >= 0.0:
            return float(brentq(growth, ratio, above, xtol=1e-4))
    return lowest
