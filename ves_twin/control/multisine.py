"""Multisine: many sines at once, every axis of the platform on lines of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import PlatformMotion, quintic

AXES = 6


@final
@dataclass(frozen=True)
class Multisine(PlatformMotion):
    """Sum of sines about a pose, faded in over `fade` seconds.

    Attributes:
        at: middle pose [m, rad] (6,).
        frequency: of every line [Hz] (n,).
        amplitude: of every line in every axis [m, rad] (n, 6).
        phase: of every line [rad] (n,).
        fade: time over which it grows smoothly from zero [s].
    """

    at: FloatArray
    frequency: FloatArray
    amplitude: FloatArray
    phase: FloatArray
    fade: float

    def pose(self, time: float) -> FloatArray:
        """Middle pose plus the faded sines."""
        if time <= 0.0:
            return self.at
        envelope = quintic(time / self.fade) if self.fade > 0.0 else 1.0
        waves = np.sin(2.0 * np.pi * self.frequency * time + self.phase)
        return np.asarray(self.at + envelope * (waves @ self.amplitude))


def multisine(
    at: FloatArray, peak: FloatArray, band: tuple[float, float], period: float, fade: float
) -> Multisine:
    """A multisine with flat speed and low crest.

    Axis a takes the lines k / period with k = a modulo 6 inside the band. Amplitudes fall as
    1 / f; phases are Schroeder's, -pi j (j - 1) / N for the j-th of the N lines of an axis.

    Args:
        at: middle pose [m, rad] (6,).
        peak: largest excursion of each axis [m, rad] (6,).
        band: lowest and highest frequency [Hz], holding at least six lines.
        period: time after which it repeats [s].
        fade: time over which it grows [s].

    Source: M. R. Schroeder, Synthesis of low-peak-factor signals, IEEE Trans. Inf. Theory 16, 1970.
    """
    lines = np.arange(int(np.ceil(band[0] * period)), int(np.floor(band[1] * period)) + 1)
    axis = lines % AXES
    frequency, phase = lines / period, np.zeros(len(lines))
    amplitude = np.zeros((len(lines), AXES))
    for a in range(AXES):
        mine = np.flatnonzero(axis == a)
        number = np.arange(1, len(mine) + 1)
        phase[mine] = -np.pi * number * (number - 1) / max(len(mine), 1)
        amplitude[mine, a] = 1.0 / frequency[mine]
    time = np.arange(0.0, period, 0.02 / band[1])
    waves = np.sin(2.0 * np.pi * np.outer(time, frequency) + phase) @ amplitude
    highest = np.abs(waves).max(axis=0)
    scale = np.divide(peak, highest, out=np.zeros(AXES), where=highest > 0.0)
    return Multisine(at, frequency, amplitude * scale, phase, fade)
