"""predict: what a plant would have measured, on the rows of a recording at any rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.replay import replay

SAME = 1e-3
"""Rows of a recording count as those of a clock if no one lies further off [periods]."""


def predict(
    recording: Recording,
    plant: Plant,
    scenario: Scenario,
    drive: Sequence[str],
    compare: Sequence[str],
) -> dict[str, FloatArray]:
    """Signals of `compare` on the recording's rows, without noise.

    The rig logs on the slowest of its clocks that is at least as fast as the recording; its
    signals are then read off, straight between rows. Set-points that come slower than the
    admittance cycle are drawn straight between rows, faster ones are held.

    Args:
        recording: on an even clock from t = 0.
        plant: the rig that is tried.
        scenario: rates, gains and start.
        drive: signals that are fed in.
        compare: signals that come back.

    Raises:
        EndedEarlyError: as `replay`.
    """
    clock = Clock.of(scenario, plant.parameters)
    tick, cycle = clock.tick, clock.admittance * clock.tick
    period = float(np.median(np.diff(recording.time)))
    clocks = {"admittance": cycle, "leg": clock.leg * tick, "tick": tick}
    log, step = next(
        ((name, p) for name, p in clocks.items() if p <= period * (1.0 + SAME)), ("tick", tick)
    )
    run = scenario.run.model_copy(update={"log": log})
    scenario = scenario.model_copy(update={"run": run})
    count = int(np.ceil(recording.time[-1] / step - SAME)) + 1
    time = np.asarray(np.arange(count) * step, np.float64)
    if abs(step / period - 1.0) < SAME and count == len(recording):
        answer = replay(replace(recording, time=time), plant, drive, compare, scenario)
        return dict(answer.signals)
    slow = period > cycle * (1.0 + SAME)
    fed = {name: _at(time, recording.time, recording[name], slow) for name in drive}
    answer = replay(Recording(time, fed, recording.info), plant, drive, compare, scenario)
    return {name: _at(recording.time, time, answer[name], True) for name in compare}


def _at(when: FloatArray, time: FloatArray, values: FloatArray, straight: bool) -> FloatArray:
    if straight:
        return np.column_stack([np.interp(when, time, column) for column in values.T])
    rows = np.searchsorted(time, when + 1e-6, "right") - 1
    return np.asarray(values[np.clip(rows, 0, len(values) - 1)])
