"""Safety: every cycle, the lengths to be sent are held against the legs' travel."""

from __future__ import annotations

import numpy as np

from ves_twin.compiled import compiled
from ves_twin.types import FloatArray


@compiled
def leg_outside(lengths: FloatArray, home: FloatArray, travel: float) -> int:
    """Number (1 to 6) of the first leg whose command leaves +-travel [m] of home, 0 if none.

    A command that is not finite counts as outside.

    Source: thesis 2.4.2 (safety checks on leg lengths, margins not given).
    """
    for i in range(lengths.shape[0]):
        if not np.abs(lengths[i] - home[i]) <= travel:
            return i + 1
    return 0
