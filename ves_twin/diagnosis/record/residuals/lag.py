"""find_lag: by how much a measured signal comes later than a simulated one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import correlate

from ves_twin.core.types import FloatArray

WIDEST = 0.25
"""Largest lag that is looked for [s]: twenty admittance cycles."""

SURE = 0.3
"""Lags are told only to this share of a row or better, else the motion was not enough."""

ALIKE = 0.5
"""Correlation below which the two signals have nothing to be timed by."""

STRETCHES = 10
"""Equal parts of the record by whose disagreement a lag is as unsure: what a model gets wrong is no
noise, and may look later in one part and earlier in another."""


@dataclass(frozen=True)
class Lag:
    """Lag of measured behind simulated [s], with its sd."""

    value: float
    sd: float


def find_lag(measured: FloatArray, simulated: FloatArray, period: float) -> Lag | None:
    """Lag by cross-correlation, refined between rows.

    The maximum of the cross-correlation gives whole rows. Around it m(t) = a + g s(t - tau) is
    linear in (a, g, g dtau) with the slope of s, which is the maximum of the correlation between
    rows. Its sd comes from what is left over: by its correlation from row to row, or by what
    STRETCHES of the record pull apart, whichever is more.

    Args:
        measured: rows (n,), finite.
        simulated: rows (n,).
        period: of the rows [s].

    Returns:
        None where the motion cannot tell.
    """
    m, s = measured - measured.mean(), simulated - simulated.mean()
    size = float(np.sqrt((m @ m) * (s @ s)))
    if not size > 0.0:
        return None
    reach = min(int(WIDEST / period) + 1, len(m) // 4)
    correlation = correlate(m, s, mode="full", method="fft")[len(m) - 1 - reach : len(m) + reach]
    if correlation.max() < ALIKE * size:
        return None
    lag = float(np.argmax(correlation) - reach)
    curve = CubicSpline(np.arange(len(s)), s)
    inner = np.arange(reach + 2, len(s) - reach - 2)
    sd = np.inf
    for _ in range(3):
        step, sd = _refined(m[inner], curve(inner - lag), curve(inner - lag, 1))
        lag = float(np.clip(lag + step, -reach, reach))
    return Lag(lag * period, sd * period) if sd < SURE else None


def _refined(m: FloatArray, s: FloatArray, slope: FloatArray) -> tuple[float, float]:
    """Further lag and its sd [rows]."""
    columns = np.column_stack([slope, s, np.ones_like(s)])
    scale = np.linalg.norm(columns, axis=0)
    if not np.all(scale > 0.0):
        return 0.0, np.inf
    inverse = np.linalg.pinv(columns / scale)
    found = inverse @ m / scale
    rest = m - columns @ found
    power = float(rest @ rest)
    if power == 0.0 or found[1] == 0.0:
        return (-found[0] / found[1] if found[1] else 0.0), 0.0
    first = float(np.clip(rest[:-1] @ rest[1:] / power, 0.0, 0.99))
    variance = power / len(m) * (1.0 + first) / (1.0 - first) * (inverse[0] @ inverse[0])
    pulls = np.array([np.sum(part) for part in np.array_split(inverse[0] * rest, STRETCHES)])
    apart = STRETCHES / (STRETCHES - 1.0) * float(pulls @ pulls)
    sd = np.sqrt(max(float(variance), apart)) / scale[0]
    return float(-found[0] / found[1]), float(sd / abs(found[1]))
