"""GravityShift: how far an error of the gravity estimate moves the emulated base."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.control.gravity import GravityCompensation
from ves_twin.control.readings import Readings
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.simulator import Simulator
from ves_twin.thesis.context import Context
from ves_twin.types import FloatArray


@final
class ScaledCompensation(GravityCompensation):
    """Another compensation's estimate times a factor: a gravity model wrong in its total mass."""

    def __init__(self, exact: GravityCompensation, factor: float) -> None:
        self._exact, self._factor = exact, factor

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """The estimate times the factor, sensor axes [N, N m] (6,)."""
        return self._factor * self._exact.wrench(time, readings)

    def snapshot(self) -> object:
        """What the other compensation keeps."""
        return self._exact.snapshot()

    def restore(self, snapshot: object) -> None:
        """Give it back."""
        self._exact.restore(snapshot)


@dataclass(frozen=True)
class GravityShift:
    """Motion in Z with the exact and with a wrong estimate of gravity.

    Attributes:
        peak: largest motion in Z with the exact estimate [m].
        shift: largest difference that the error makes [m].
        outcome: how the run with the error ended.
    """

    peak: float
    shift: float
    outcome: str


def gravity_shift(
    context: Context, scenario: str, changes: Mapping[str, object], share: float
) -> GravityShift:
    """The shift by an error of the whole gravity wrench that begins at t = 0, after zeroing.

    Args:
        context: the world.
        scenario: a micro-gravity scenario whose gravity method is `truth`.
        changes: keys of it that are changed.
        share: relative error of the estimate, for instance 0.005.
    """
    exact, _ = _poses(context, scenario, changes, 0.0)
    wrong, outcome = _poses(context, scenario, changes, share)
    rows = min(len(exact), len(wrong))
    if rows == 0:
        return GravityShift(float("nan"), float("nan"), outcome)
    z, z_wrong = exact[:rows, 2] - exact[0, 2], wrong[:rows, 2] - exact[0, 2]
    return GravityShift(float(np.max(np.abs(z))), float(np.max(np.abs(z_wrong - z))), outcome)


def _poses(
    context: Context, scenario: str, changes: Mapping[str, object], share: float
) -> tuple[FloatArray, str]:
    """Poses (n, 6) of a run with a share of gravity too much in the estimate, and its outcome."""

    def make() -> tuple[FloatArray, str]:
        sim = Simulator(context.plant, Scenario.load(scenario, changes))
        sim.computers.gravity = ScaledCompensation(sim.computers.gravity, 1.0 + share)
        sim.advance(sim.scenario.run.duration)
        sink = sim.recorder.sink
        signals = sink.collect()[1] if isinstance(sink, MemorySink) else {}
        outcome = sim.outcome.value if sim.outcome else "unfinished"
        return signals.get("truth.pose", np.zeros((0, 6))), outcome

    poses: tuple[FloatArray, str] = context.once(f"gravity {scenario} {changes} {share}", make)
    return poses
