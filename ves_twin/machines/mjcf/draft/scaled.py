"""scales_of: efforts that are all a part more, or less, than the model needs; words for them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.machines.mjcf.draft.effort_fit import STRONG, EffortFit
from ves_twin.machines.mjcf.draft.match import Match

TOLD = 1.2
"""Factor from which on it is told: a torque's constant is seldom known better than to a tenth."""


def scales_of(fits: Mapping[Match, EffortFit]) -> dict[Match, float]:
    """Times what the model needs that the log has, of efforts that tell it beside friction."""
    return {
        match: abs(fit.slope)
        for match, fit in fits.items()
        if fit.usable and not fit.free and fit.gain > STRONG
    }


def words_of_scale(scales: Mapping[Match, float]) -> list[str]:
    """One sentence for all efforts that the model explains by another factor than one; or none."""
    if not any(abs(np.log(times)) > np.log(TOLD) for times in scales.values()):
        return []
    told = ", ".join(f"{times:.2f} times ({match.column})" for match, times in scales.items())
    return [f"beside friction the log has {told} what the model needs: masses, rotors, or a gain?"]
