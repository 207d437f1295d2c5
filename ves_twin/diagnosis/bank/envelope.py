"""envelope_sd: how far a machine in order may be from its model, row by row."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import SingleArray
from ves_twin.diagnosis.bank.linearise import Linearisation

ENVELOPE_SD = 2.0
"""Half-width of a drawn envelope in sd: a machine in order is inside in 95 % of the rows."""


def envelope_sd(base: Linearisation) -> SingleArray:
    """Sd of one row of each channel, of noise and of all commissioning tolerances (rows, c).

    sd^2 = sum_k (df/dx_k sd_k)^2 + noise^2, linear in the tolerances; in the channels' units. Noise
    is the declared one as the analysis grid passes it.
    """
    runs = base.runs
    spread = np.einsum("krc,krc->rc", base.columns, base.columns)
    for rows, grid in zip(runs.slices, runs.grids, strict=True):
        channels = [runs.forward.channels[c] for c in runs.columns]
        noise = [grid.autocovariance(one.sd, 0, one.corner)[0] for one in channels]
        spread[rows] += np.array(noise, np.float32)
    return np.asarray(np.sqrt(spread), np.float32)
