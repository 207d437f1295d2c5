"""words_of_scale: that efforts are all a part more, or less, than the model needs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.machines.mjcf.draft.effort_fit import STRONG, EffortFit
from ves_twin.machines.mjcf.draft.match import Match

TOLD = 1.2
"""Factor from which on it is told: a torque's constant is seldom known better than to a tenth."""


def words_of_scale(fits: Mapping[Match, EffortFit]) -> list[str]:
    """One sentence for all efforts that the model explains by another factor than one; or none.

    Args:
        fits: of efforts, beside friction.
    """
    plain = {
        match.column: abs(fit.slope)
        for match, fit in fits.items()
        if fit.usable and not fit.free and fit.gain > STRONG
    }
    if not any(abs(np.log(times)) > np.log(TOLD) for times in plain.values()):
        return []
    told = ", ".join(f"{times:.2f} times ({name})" for name, times in plain.items())
    return [f"beside friction the log has {told} what the model needs: its masses, or a gain?"]
