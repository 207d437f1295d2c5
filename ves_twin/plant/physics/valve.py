"""valve: servovalve spool as a first-order lag, averaged exactly over a step."""

from __future__ import annotations

import numpy as np

from ves_twin.compiled import compiled
from ves_twin.types import FloatArray, Record

PARAMETERS = np.dtype([("lag", np.float64)])
"""lag: time constant of the spool [s]."""

STATE = np.dtype([("spool", np.float64, 6), ("mean", np.float64, 6)])
"""spool: opening, -1 to 1; mean: its mean over the last step."""


@compiled
def move_spool(p: Record, s: Record, current: FloatArray, step: float) -> None:
    """Advance the spools: x' = (c - x) / lag, with c the held current.

    The mean over the step, c + (x0 - c)(1 - e^(-h/lag)) lag / h, drives the flow: the end value
    would be a half-step lead, which is most of the error of a naive scheme.

    Args:
        p: PARAMETERS.
        s: STATE.
        current: amplifier output, -1 to 1 (6,).
        step: physics step h [s].
    """
    decay = np.exp(-step / p.lag)
    for i in range(6):
        gap = s.spool[i] - current[i]
        s.mean[i] = current[i] + gap * (1.0 - decay) * p.lag / step
        s.spool[i] = current[i] + gap * decay
