"""LegResponse: frequency response of the leg loops, measured in the full simulation.

The platform follows a small sine in Z under position control; the phasors of commanded length,
measured length and valve command over whole periods give the loop closed and open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.procedures.response.sine_fit import fit_sine
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.thesis.context import Context

AMPLITUDE = 1e-3
"""Sine in Z [m]: small against the stroke, large against transducer counts."""

FADE, PERIODS, SHORTEST = 0.5, 4, 1.0
"""The sine grows over FADE s; the fit takes PERIODS periods, at least SHORTEST s."""

HALF_POWER = 1.0 / np.sqrt(2.0)
HIGHEST = 24.0
"""Highest frequency tried [Hz], well below half the rate of the commands."""

LOWEST = 0.05
"""Below this no more octave downwards is tried [Hz]."""


@dataclass(frozen=True)
class LegResponse:
    """Response at one frequency, mean of the six legs.

    Attributes:
        frequency: of the sine [Hz].
        closed: measured length over commanded length.
        opened: measured length over valve command [m].
        command: command of the simulation.
    """

    frequency: float
    closed: complex
    opened: complex
    command: str


@dataclass(frozen=True)
class Bandwidth:
    """Lowest frequency [Hz] at which the closed loop is down by 3 dB; nan if there is none."""

    frequency: float
    runs: tuple[str, ...]


def leg_response(context: Context, legs: LegSettings, frequency: float) -> LegResponse:
    """Response of the legs at a frequency [Hz]."""
    frequency = float(f"{frequency:.4g}")
    length = max(SHORTEST, PERIODS / frequency)
    duration = round(FADE + 0.5 + length, 4)  # half a second for the transient of the fade
    changes: dict[str, object] = {
        "run.duration": duration,
        "run.settle": 0.5,
        "run.noise": False,
        "run.log": "leg",
        "platform.motion.amplitude": [0.0, 0.0, AMPLITUDE, 0.0, 0.0, 0.0],
        "platform.motion.frequency": [frequency] * 6,
        "platform.motion.fade": FADE,
        "legs.gain": legs.gain,
        "legs.rate_gain": legs.rate_gain,
        "legs.filter": legs.place.value,
    }
    run = context.run("position_sine", changes)
    last = run.recording.window(duration - round(length * frequency) / frequency, np.inf)
    phasors = {
        name: fit_sine(last.time, last[name], frequency)
        for name in ("leg.command", "leg.length", "valve.command")
    }
    closed = phasors["leg.length"] / phasors["leg.command"]
    opened = phasors["leg.length"] / phasors["valve.command"]
    return LegResponse(frequency, complex(np.mean(closed)), complex(np.mean(opened)), run.command)


def bandwidth(context: Context, legs: LegSettings) -> Bandwidth:
    """Bandwidth of the closed leg loop: octaves upwards, then secants on the log of frequency.

    It begins at half the corner of the integrator alone, gain / (4 pi), which no loop of the rig
    has fallen below; if one has, octaves lead downwards first. Slow sines are what costs time.
    """
    low = leg_response(context, legs, legs.gain / (4.0 * np.pi))
    runs = [low.command]
    while abs(low.closed) < HALF_POWER:
        if low.frequency <= LOWEST:
            return Bandwidth(float("nan"), tuple(runs))
        low = leg_response(context, legs, 0.5 * low.frequency)
        runs.append(low.command)
    while True:
        high = leg_response(context, legs, 2.0 * low.frequency)
        runs.append(high.command)
        if abs(high.closed) < HALF_POWER:
            break
        if high.frequency >= HIGHEST:
            return Bandwidth(float("nan"), tuple(runs))
        low = high
    for _ in range(4):
        middle = leg_response(context, legs, _crossing(low, high))
        runs.append(middle.command)
        low, high = (middle, high) if abs(middle.closed) >= HALF_POWER else (low, middle)
    return Bandwidth(_crossing(low, high), tuple(runs))


def _crossing(low: LegResponse, high: LegResponse) -> float:
    """Frequency of -3 dB between two points: linear in log magnitude over log frequency."""
    above, below = (np.log(abs(r.closed) / HALF_POWER) for r in (low, high))
    share = above / (above - below)
    return float(low.frequency * (high.frequency / low.frequency) ** share)
