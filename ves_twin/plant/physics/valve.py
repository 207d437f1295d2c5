"""valve: servovalve spool as a first-order lag with its faults, averaged over a step."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record

PARAMETERS = np.dtype(
    [
        ("lag", np.float64, 6),
        ("null", np.float64, 6),
        ("deadband", np.float64, 6),
        ("gain", np.float64, 6),
        ("limit", np.float64, 6),
    ]
)
"""lag: time constant of the spool [s]; null: opening without current; deadband: overlap of the
lands on each side; gain: flow per nominal flow; limit: largest travel. All but lag are shares of
full opening."""

STATE = np.dtype(
    [
        ("spool", np.float64, 6),
        ("mean", np.float64, 6),
        ("step", np.float64),
        ("decay", np.float64, 6),
        ("share", np.float64, 6),
    ]
)
"""spool: travel, -1 to 1; mean: opening that the flow sees, mean over the last step; decay: of a
gap over a step of length `step` [s]; share: mean of the gap over it."""


@compiled
def move_spool(p: Record, s: Record, current: FloatArray, step: float) -> None:
    """Advance the spools and give the openings.

        x' = (c - x) / lag,  c = the held current, within +-limit
        opening = gain * D(mean of x over the step + null)
        D(y) = sign(y) max(|y| - deadband, 0)

    The mean, c + (x0 - c)(1 - e^(-h/lag)) lag / h, drives the flow: the end value would be a
    half-step lead, which is most of the error of a naive scheme. D of the mean differs from the
    mean of D only in steps that cross an edge of the deadband.

    Args:
        p: PARAMETERS; the lags may not change within a run.
        s: STATE.
        current: amplifier output, -1 to 1 (6,).
        step: physics step h [s].

    Source: Merritt, Hydraulic Control Systems (1967), chapter 5 (overlap, null shift).
    """
    if s.step != step:  # at the first step: six exponentials a tick cost a fifth of the loop
        s.step = step
        for i in range(6):
            s.decay[i] = np.exp(-step / p.lag[i])
            s.share[i] = (1.0 - s.decay[i]) * p.lag[i] / step
    for i in range(6):
        command = min(max(current[i], -p.limit[i]), p.limit[i])
        gap = s.spool[i] - command
        open_by = command + gap * s.share[i] + p.null[i]
        s.spool[i] = command + gap * s.decay[i]
        beyond = max(abs(open_by) - p.deadband[i], 0.0)
        s.mean[i] = p.gain[i] * (beyond if open_by >= 0.0 else -beyond)
