"""SampledLoop: the whole sampled loop about rest, linearised; its growth rates without a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import reduce
from math import gcd, lcm

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.plant.plant import Plant
from ves_twin.simulator.loop_state import STEP, LoopState
from ves_twin.simulator.simulator import Simulator

LOWEST_FREQUENCY = 2.0
"""Oscillations from here up are vibrations [Hz]; the emulated beams swing below it."""

FORGOTTEN = 1e-6
"""Multipliers below this have died out within one common period."""


@dataclass(frozen=True)
class LoopMode:
    """One oscillation of the closed sampled loop.

    Attributes:
        growth: rate of growth [1/s], negative if it decays.
        frequency: of its strongest harmonic in the mechanics [Hz].
    """

    growth: float
    frequency: float


class SampledLoop:
    """Transition of everything that the rig and its computers remember, about rest.

    The clocks of legs, amplifiers and admittance make the loop periodic with their least common
    multiple: 5, 3 and 37 ticks repeat every 555. One tick has four transitions, with or without
    leg loop and amplifiers, and an admittance cycle adds one of its own; all are centred
    differences of the code that runs. Their product over the common period is the monodromy
    matrix; its eigenvalues are the Floquet multipliers, exp(s P) for a mode of rate s.

    Args:
        sim: a simulator at t = 0 whose rest is a steady state: noise off, and no resolution on
            its readings (`smooth_readings`). It serves as the bench and ends at its rest.
        opening: step of the spool openings. The gain of an orifice at null differs by direction,
            and standing legs lie beside null by what leaks: a small step gives the tangent at
            rest, a step of several times that opening the mean of both directions.

    Raises:
        InvalidInputError: a controller whose state is not an array.

    Source: Floquet theory, for instance Coddington and Levinson (1955), chapter 3.
    """

    def __init__(self, sim: Simulator, opening: float = STEP) -> None:
        self._sim = sim
        clock = sim.rig.clock
        self._state = LoopState(sim, opening)
        self._pattern = lcm(clock.leg, clock.amplifier)
        self._cycles = self._pattern // gcd(self._pattern, clock.admittance)
        self.period = self._cycles * clock.admittance * clock.tick
        kinds = {self._kind(n): self._tick(n) for n in range(self._pattern)}
        ticks = {kind: self._state.jacobian(advance) for kind, advance in kinds.items()}
        cycle = self._state.jacobian(self._cycle)
        self._kept = _kept([*ticks.values(), cycle])
        moving = self._kept < self._state.displacements.stop
        self._moving = np.flatnonzero(moving)
        self._between = self._transitions({k: self._cut(t) for k, t in ticks.items()})

    def modes(self, lowest: float = LOWEST_FREQUENCY) -> list[LoopMode]:
        """Oscillations of the loop with the simulator's present controller, fastest growth first.

        Only the admittance cycle is linearised anew, so that many emulated systems on one rig
        cost little.

        Args:
            lowest: leave out modes below this [Hz].
        """
        cycle = self._cut(self._state.jacobian(self._cycle))
        steps = [between @ cycle for between in self._between]
        multipliers, shapes = np.linalg.eig(reduce(lambda product, step: step @ product, steps))
        alive = np.flatnonzero(np.abs(multipliers) > FORGOTTEN)
        frequency = self._frequencies(steps, multipliers[alive], shapes[:, alive])
        found = [
            LoopMode(float(np.log(abs(multipliers[i])) / self.period), abs(float(f)))
            for i, f in zip(alive, frequency, strict=True)
            if abs(f) >= lowest and multipliers[i].imag >= 0.0  # one of each conjugate pair
        ]
        return sorted(found, key=lambda mode: -mode.growth)

    def _frequencies(
        self, steps: list[FloatArray], multipliers: FloatArray, shapes: FloatArray
    ) -> FloatArray:
        """Frequency of each mode [Hz]: the strongest harmonic of its motion over one period.

        A multiplier gives the frequency only up to multiples of 1 / P. The motion of a mode is
        exp(s t) times a periodic part; the largest Fourier term of that part says which.
        """
        rate = np.log(multipliers.astype(complex)) / len(steps)
        motion, vector = [], shapes
        for k, step in enumerate(steps):
            motion.append(vector[self._moving] * np.exp(-rate * k))
            vector = step @ vector
        power = np.sum(np.abs(np.fft.fft(np.array(motion), axis=0)) ** 2, axis=1)
        harmonic = np.fft.fftfreq(len(steps), 1.0 / len(steps))[np.argmax(power, axis=0)]
        turns = np.angle(multipliers) / (2.0 * np.pi)
        return np.asarray((turns + harmonic) / self.period)

    def _transitions(self, ticks: dict[tuple[bool, bool], FloatArray]) -> list[FloatArray]:
        """Product of all ticks between two admittance cycles, for each cycle of the period."""
        pattern, length = self._pattern, self._sim.rig.clock.admittance

        def product(numbers: Iterable[int]) -> FloatArray:
            return reduce(lambda total, n: ticks[self._kind(n)] @ total, numbers, np.eye(size))

        size = len(self._kept)
        whole, rest = divmod(length, pattern)
        result = []
        for k in range(self._cycles):
            first = k * length % pattern
            turn = np.linalg.matrix_power(product(range(first, first + pattern)), whole)
            result.append(product(range(first, first + rest)) @ turn)
        return result

    def _cut(self, transition: FloatArray) -> FloatArray:
        return np.asarray(transition[np.ix_(self._kept, self._kept)])

    def _kind(self, n: int) -> tuple[bool, bool]:
        clock = self._sim.rig.clock
        return n % clock.leg == 0, n % clock.amplifier == 0

    def _tick(self, n: int) -> Callable[[], None]:
        """One tick of the rig whose clocks strike as at tick n; before t = 0, so nothing logs."""
        rig, log = self._sim.rig, self._sim.recorder.log
        tick = n - self._pattern

        def advance() -> None:
            rig.tick = tick
            rig.state["cycle_start"] = tick
            rig.run(1, log, 0)

        return advance

    def _cycle(self) -> None:
        rig = self._sim.rig
        tick = -self._pattern
        self._sim.computers.cycle(tick, tick * rig.clock.tick)


def smooth_readings(plant: Plant) -> Plant:
    """The plant with readings of unlimited resolution, which differences need."""
    return plant.with_values(
        {
            "transducer.resolution": 0.0,
            "sensor.resolution": [0.0] * 6,
            "arm.encoder_resolution": [0.0] * 3,
        }
    )


def _kept(transitions: list[FloatArray]) -> IntArray:
    """Coordinates that something else still looks at; dropping the others changes no mode."""
    looked_at = np.any(np.array(transitions) != 0.0, axis=0)
    np.fill_diagonal(looked_at, False)
    kept = np.arange(len(looked_at))
    while True:
        seen = looked_at[np.ix_(kept, kept)].any(axis=0)
        if seen.all():
            return kept
        kept = kept[seen]
