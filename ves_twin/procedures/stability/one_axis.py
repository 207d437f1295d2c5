"""OneAxis: the admittance loop of one stiff axis, sampled as the rig is sampled."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import lcm

import numpy as np

from ves_twin.control.leg_loop import FilterPlace, chebyshev_section
from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.plant.hydraulics import Hydraulics
from ves_twin.plant.plant import Plant

_ROD, _SPEED, _HELD, _VALVE, _Z1, _Z2, _B1, _B2, _READING, _POSE, _RATE, _COMMAND = range(12)
_STATES = 12

LOWEST, HIGHEST = 0.02, 4.0
"""Ratios of mass to payload that are tried."""


@dataclass(frozen=True)
class OneAxis:
    """A payload on one axis that follows v' = (u - v) / lag, x' = v, under leg loop and admittance.

    No structure, no oil spring, no rotation: what is left are the clocks, the valve's lag, the
    leg filter and the 20 Hz low-pass of the force sensor.

    Attributes:
        gain: of the leg loop [1/s].
        place: what the leg filter filters.
        edge: of the leg filter [Hz].
        lag: of valve and oil [s].
        corner: of the force sensor's low-pass [Hz].
        tick: period of the transducers [s].
        clocks: periods of leg loop, amplifiers and admittance [ticks].

    Source: thesis 5.3, 5.4.
    """

    gain: float
    place: FilterPlace
    edge: float
    lag: float
    corner: float
    tick: float
    clocks: tuple[int, int, int]

    @staticmethod
    def of(plant: Plant, gain: float, place: FilterPlace, edge: float, rate: float) -> OneAxis:
        """The axis of a plant's numbers; the linear form's oil adds damping over stiffness as lag.

        Args:
            plant: the rig.
            gain: of the leg loop [1/s].
            place: what the leg filter filters.
            edge: of the leg filter [Hz].
            rate: of the admittance cycle [Hz].

        Raises:
            InvalidInputError: legs that differ, by a number or an effect.
        """
        number = plant.actual.number
        lag, tick = number("hydraulics.valve_lag"), number("clock.tick")
        if plant.hydraulics is Hydraulics.LINEAR:
            lag += number("hydraulics.oil_damping") / number("hydraulics.oil_stiffness")
        leg, amplifier = number("clock.leg_ticks"), number("clock.amplifier_ticks")
        clocks = round(leg), round(amplifier), max(1, round(1.0 / (rate * tick)))
        return OneAxis(gain, place, edge, lag, number("sensor.corner"), tick, clocks)

    def growth(self, ratio: float) -> float:
        """Growth rate of the fastest oscillation [1/s] at a mass of `ratio` times the payload."""
        period = lcm(*self.clocks)
        state = np.eye(_STATES)
        for n in range(period):
            if n % self.clocks[2] == 0:
                self._cycle(state, ratio)
            self._advance(state, n)
        multipliers = np.abs(np.linalg.eigvals(state))
        # two multipliers are 1: a free mass coasts, and stays where it is
        free = np.argsort(np.abs(multipliers - 1.0))[:2]
        return float(np.log(np.max(np.delete(multipliers, free))) / (period * self.tick))

    def lowest_stable_ratio(self) -> float:
        """Lowest stable ratio of mass to payload; the ends of the range where there is none."""
        if self.growth(HIGHEST) > 0.0:
            return HIGHEST
        if self.growth(LOWEST) < 0.0:
            return LOWEST
        below, above = np.log([LOWEST, HIGHEST])
        while above - below > 0.002:
            middle = 0.5 * (below + above)
            below, above = (middle, above) if self.growth(np.exp(middle)) > 0 else (below, middle)
        return float(np.exp(0.5 * (below + above)))

    def leg_response(self, frequency: FloatArray, rate_gain: float = 0.0) -> ComplexArray:
        """Response of the leg loop alone, command to length, at frequencies [Hz].

        X / C = k F_C G / (1 + (k F + k2 d) G), G = e^(-s D) / (s (1 + s lag)), with F the
        section, d the backward difference over a leg period and D half that period and the mean
        wait for the amplifier.
        """
        leg, amplifier, _ = self.clocks
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        period = leg * self.tick
        delay = 0.5 * period + 0.5 * (amplifier - 1) * self.tick
        plant = np.exp(-s * delay) / (s * (1.0 + s * self.lag))
        z = np.exp(-s * period)
        b, a = _section(1.0 / period, self.edge)
        section = (b[0] + b[1] * z + b[2] * z**2) / (a[0] + a[1] * z + a[2] * z**2)
        on_error = section if self.place is FilterPlace.ERROR else 1.0
        around = 1.0 if self.place is FilterPlace.NONE else section
        speed = rate_gain * (1.0 - z) / period
        return np.asarray(
            self.gain * on_error * plant / (1.0 + (self.gain * around + speed) * plant)
        )

    def bandwidth(self, rate_gain: float = 0.0) -> float:
        """Frequency at which the leg loop has fallen by 3 dB [Hz]."""
        f = np.geomspace(0.05, 40.0, 4000)
        fallen = np.abs(self.leg_response(f, rate_gain)) < np.sqrt(0.5)
        return float(f[int(np.argmax(fallen))])

    def _cycle(self, x: FloatArray, ratio: float) -> None:
        """X(k+1) of a free mass under the reading, in units of the payload."""
        period = self.clocks[2] * self.tick
        push = x[_READING] / ratio
        x[_POSE] += period * x[_RATE] + 0.5 * period**2 * push
        x[_RATE] += period * push
        x[_COMMAND] = x[_POSE]

    def _advance(self, x: FloatArray, n: int) -> None:
        """One tick: leg loop, amplifier, valve and rod, force sensor."""
        b, a = _section(1.0 / (self.clocks[0] * self.tick), self.edge)
        if n % self.clocks[0] == 0:
            error = x[_COMMAND] - x[_ROD]
            taken = x[_ROD] if self.place is FilterPlace.FEEDBACK else error
            y = b[0] * taken + x[_Z1]
            x[_Z1] = b[1] * taken - a[1] * y + x[_Z2]
            x[_Z2] = b[2] * taken - a[2] * y
            if self.place is FilterPlace.ERROR:
                error = y
            elif self.place is FilterPlace.FEEDBACK:
                error = x[_COMMAND] - y
            x[_VALVE] = self.gain * error
        if n % self.clocks[1] == 0:
            x[_HELD] = x[_VALVE]
        b, a = _low_pass(self.corner, 1.0 / self.tick)
        force = -(x[_HELD] - x[_SPEED]) / self.lag
        y = b[0] * force + x[_B1]
        x[_B1] = b[1] * force - a[1] * y + x[_B2]
        x[_B2] = b[2] * force - a[2] * y
        x[_READING] = y
        decay = np.exp(-self.tick / self.lag)
        gap = x[_SPEED] - x[_HELD]
        x[_ROD] += self.tick * x[_HELD] + self.lag * (1.0 - decay) * gap
        x[_SPEED] = x[_HELD] + decay * gap


@lru_cache(maxsize=16)
def _section(rate: float, edge: float) -> tuple[FloatArray, FloatArray]:
    return chebyshev_section(rate, edge)


@lru_cache(maxsize=16)
def _low_pass(corner: float, rate: float) -> tuple[FloatArray, FloatArray]:
    from scipy.signal import butter  # slow to import

    numerator, denominator = butter(2, corner, fs=rate)
    return np.asarray(numerator), np.asarray(denominator)
