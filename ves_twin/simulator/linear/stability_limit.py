"""stability_limit: the lightest model that the emulation of one axis carries."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.admittance_loop import AxisModel, admittance_loop, payload_mass
from ves_twin.simulator.linear.leg_settings import LegSettings

LOWEST, HIGHEST = 0.02, 4.0
"""Ratios that are tried."""


def stability_limit(plant: Plant, settings: LegSettings, rate: float) -> float:
    """Least mass of the trial model, over the payload's, above which the axis is stable.

    Searched from above, so that a stable island below an unstable range does not count.

    Args:
        plant: numbers.
        settings: the leg loops.
        rate: admittance cycles [Hz].

    Returns:
        LOWEST where all are stable, infinity where HIGHEST is not.

    Source: thesis 5.4 (half the payload mass with the filter on the error).
    """
    from scipy.optimize import brentq  # slow to import

    payload = payload_mass(plant)

    def growth(ratio: float) -> float:
        return admittance_loop(plant, settings, AxisModel.trial(ratio * payload), rate).growth

    ratios = np.geomspace(HIGHEST, LOWEST, 24)
    if growth(HIGHEST) >= 0.0:
        return float("inf")
    for above, ratio in pairwise(ratios):
        if growth(float(ratio)) >= 0.0:
            return float(brentq(growth, ratio, above, xtol=1e-4))
    return LOWEST
