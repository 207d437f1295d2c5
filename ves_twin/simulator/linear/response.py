"""FrequencyResponse and StepResponse: what a linear system answers, with the usual numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import ComplexArray, FloatArray

if TYPE_CHECKING:
    from control import StateSpace, TransferFunction

HALF_POWER = float(np.sqrt(0.5))


@dataclass(frozen=True)
class FrequencyResponse:
    """Complex gain at frequencies.

    Attributes:
        frequency: [Hz] (n,).
        gain: output over input (n,).
    """

    frequency: FloatArray
    gain: ComplexArray

    @property
    def decibel(self) -> FloatArray:
        """Magnitude [dB] (n,)."""
        return np.asarray(20.0 * np.log10(np.abs(self.gain)))

    @property
    def degrees(self) -> FloatArray:
        """Phase [deg] (n,), unwrapped from the first frequency on."""
        return np.degrees(np.unwrap(np.angle(self.gain)))


@dataclass(frozen=True)
class StepResponse:
    """Answer to a unit step.

    Attributes:
        time: [s] (n,).
        value: (n,), 1 when settled.
    """

    time: FloatArray
    value: FloatArray

    @property
    def overshoot(self) -> float:
        """Largest value beyond 1, as a share of the step."""
        return max(float(np.max(self.value)) - 1.0, 0.0)

    @property
    def rise_time(self) -> float:
        """Time from 10 % to 90 % [s]; nan where 90 % is not reached."""
        reached = [np.flatnonzero(self.value >= level) for level in (0.1, 0.9)]
        if not len(reached[1]):
            return float("nan")
        return float(self.time[reached[1][0]] - self.time[reached[0][0]])


def frequency_response(
    system: StateSpace | TransferFunction, frequency: FloatArray
) -> FrequencyResponse:
    """Complex gain of a sampled system with one input and one output.

    Args:
        system: sampled with `system.dt` [s].
        frequency: [Hz], below half the sampling rate (n,).

    Raises:
        InvalidInputError: frequencies that the sampling cannot carry.
    """
    frequency = np.asarray(frequency, dtype=float)
    if np.any(frequency < 0.0) or np.any(frequency > 0.5 / system.dt):
        raise InvalidInputError(
            "frequency", frequency.tolist(), f"0 to {0.5 / system.dt:.1f} Hz, half the rate"
        )
    z = np.exp(2j * np.pi * frequency * system.dt)
    return FrequencyResponse(frequency, np.atleast_1d(np.asarray(system(z), dtype=complex)))


def bandwidth(system: StateSpace) -> float:
    """First frequency at which the gain is 3 dB below 1 [Hz]; nan where there is none.

    Raises:
        InvalidInputError: an unstable system, which has no bandwidth.
    """
    from scipy.optimize import brentq  # slow to import

    fastest = float(np.max(np.abs(system.poles())))
    if fastest >= 1.0:
        raise InvalidInputError("loop", f"a pole at |z| = {fastest:.4f}", "a stable loop")

    def excess(hertz: float) -> float:
        return float(np.abs(system(np.exp(2j * np.pi * hertz * system.dt)))) - HALF_POWER

    grid = np.geomspace(0.01, 0.45 / system.dt, 2000)
    below = np.flatnonzero(np.abs(frequency_response(system, grid).gain) < HALF_POWER)
    if not len(below) or below[0] == 0:
        return float("nan")
    return float(brentq(excess, grid[below[0] - 1], grid[below[0]]))


def resonance(system: StateSpace) -> float:
    """Largest gain over all frequencies, relative to 1 [dB]; 0 where nothing is amplified."""
    grid = np.geomspace(0.01, 0.45 / system.dt, 4000)
    return max(float(np.max(frequency_response(system, grid).decibel)), 0.0)


def step_response(system: StateSpace, duration: float) -> StepResponse:
    """Answer to a unit step at t = 0, at the samples of the system.

    Args:
        system: one input, one output.
        duration: [s].
    """
    import control  # slow to import

    time = np.arange(int(duration / system.dt) + 1) * system.dt
    return StepResponse(time, np.asarray(control.step_response(system, time).outputs))
