"""force_sensor: the chain from the true wrench to the number that the computer reads."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record, SingleArray

PARAMETERS = np.dtype(
    [
        ("gain", np.float64, (6, 6)),
        ("offset", np.float64, 6),
        ("drift", np.float64, 6),
        ("noise", np.float64, 6),
        ("wander", np.float64, 6),
        ("wander_decay", np.float64),
        ("wander_kick", np.float64),
        ("numerator", np.float64, 3),
        ("denominator", np.float64, 3),
        ("range", np.float64, 6),
        ("resolution", np.float64, 6),
        ("calibration", np.float64, (6, 6)),
    ]
)
"""gain: signal per wrench, cross-talk off the diagonal; drift [1/s]; noise: white sd per sample;
wander: sd of the slow part, its decay and kick per step; low-pass coefficients; range; counts;
calibration: what the computer multiplies with."""

STATE = np.dtype(
    [
        ("z1", np.float64, 6),
        ("z2", np.float64, 6),
        ("wander", np.float64, 6),
        ("signal", np.float64, 6),
        ("zero", np.float64, 6),
        ("reading", np.float64, 6),
        ("true", np.float64, 6),
        ("raw", np.float64, 6),
    ]
)
"""Low-pass registers, slow noise, filtered signal, zero, calibrated reading, true wrench, signal
before the low-pass."""


@compiled
def start_at(p: Record, s: Record, wrench: FloatArray, wander: SingleArray) -> None:
    """Put the chain into the steady state of a constant wrench.

    Args:
        p: PARAMETERS.
        s: STATE.
        wrench: wrench of the payload on the platform, sensor axes [N, N m] (6,).
        wander: standard normal numbers for the slow noise (6,).
    """
    b, a = p.numerator, p.denominator
    for i in range(6):
        s.wander[i] = p.wander[i] * wander[i]
        x = p.offset[i] + s.wander[i]
        for j in range(6):
            x += p.gain[i, j] * wrench[j]
        y = x * (b[0] + b[1] + b[2]) / (1.0 + a[1] + a[2])
        s.z2[i] = b[2] * x - a[2] * y
        s.z1[i] = b[1] * x - a[1] * y + s.z2[i]
        s.signal[i] = y
        s.true[i] = wrench[i]


@compiled
def wander_on(p: Record, s: Record, normal: SingleArray) -> None:
    """Advance the slow noise, x <- decay x + kick sd n: below 1 Hz (Gauss-Markov)."""
    for i in range(6):
        s.wander[i] = p.wander_decay * s.wander[i] + p.wander_kick * p.wander[i] * normal[i]


@compiled
def sample_wrench(
    p: Record, s: Record, wrench: FloatArray, time: float, white: SingleArray
) -> bool:
    """One sample: gain, offset, drift, noise, low-pass, range, counts, zero.

    Args:
        p: PARAMETERS.
        s: STATE; `reading` is C (signal - zero).
        wrench: true wrench of the payload on the platform, sensor axes [N, N m] (6,).
        time: time since the start of the run, for drift [s].
        white: standard normal numbers of the white noise (6,).

    Returns:
        Whether every axis is within range.

    Source: thesis 3.2.4, 3.4.5, Appendices D and F.
    """
    b, a = p.numerator, p.denominator
    inside = True
    for i in range(6):
        s.true[i] = wrench[i]
        s.raw[i] = p.offset[i] + p.drift[i] * time + s.wander[i] + p.noise[i] * white[i]
    for j in range(6):  # six sums side by side do not wait for each other
        for i in range(6):
            s.raw[i] += p.gain[i, j] * wrench[j]
    for i in range(6):
        x = s.raw[i]
        y = b[0] * x + s.z1[i]
        s.z1[i] = b[1] * x - a[1] * y + s.z2[i]
        s.z2[i] = b[2] * x - a[2] * y
        if not abs(y) <= p.range[i]:
            inside = False
            y = min(max(y, -p.range[i]), p.range[i])
        s.signal[i] = np.rint(y / p.resolution[i]) * p.resolution[i] if p.resolution[i] > 0.0 else y
        s.reading[i] = 0.0
    for j in range(6):
        signal = s.signal[j] - s.zero[j]
        for i in range(6):
            s.reading[i] += p.calibration[i, j] * signal
    return inside
