"""run_point: one point of a sweep, in whatever process it is."""

from __future__ import annotations

import hashlib
import os
import platform
from dataclasses import asdict
from time import perf_counter

import numpy as np

from ves_twin.core.errors import VesTwinError, one_line
from ves_twin.core.recording.recording import Recording
from ves_twin.effects.registry import parse_effects
from ves_twin.simulator.emulation_error import emulation_error
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.recorder import IDEAL, LEG_LAG
from ves_twin.simulator.simulate import simulate, versions
from ves_twin.simulator.tracking_error import tells_tracking, tracking_error
from ves_twin.sweeps.point import Point
from ves_twin.sweeps.result import ERROR, LOST, REFUSED, AxisResult, PointResult, TrackingResult


class ForeignWorkerError(VesTwinError):
    """A worker whose program or models are not those of the sweep."""


def run_point(point: Point) -> PointResult:
    """Run a point; whatever goes wrong in the run is its outcome.

    Raises:
        ForeignWorkerError: this process has other versions, or other model files.
    """
    _check_program(point)
    begin = perf_counter()
    try:
        return _with_run(point, simulate(point.scenario, point.plant), begin)
    except VesTwinError as error:
        return _without_run(point, REFUSED, one_line(error))
    except Exception as error:
        return _without_run(point, ERROR, f"{type(error).__name__}: {one_line(error)}")


def lost_point(point: Point, reason: str) -> PointResult:
    """The result of a point whose worker died each time."""
    return PointResult(number=point.number, run_id=point.run_id, outcome=LOST, reason=reason)


def run_hash(recording: Recording) -> str:
    """Hash over the times and every signal of a recording: equal hash, equal run to the bit."""
    digest = hashlib.sha256(np.ascontiguousarray(recording.time).tobytes())
    for name in sorted(recording.signals):
        digest.update(name.encode() + np.ascontiguousarray(recording.signals[name]).tobytes())
    return digest.hexdigest()[:16]


def _check_program(point: Point) -> None:
    here = versions()
    for name, version in point.versions.items():
        if here.get(name) != version:
            raise ForeignWorkerError(
                f"worker {_host()} has {name} {here.get(name)}, the sweep {version}; install the"
                " same versions on every worker"
            )
    world = point.plant.with_values(point.scenario.parameters)
    found = world.extended(*parse_effects(point.scenario.effects)).hash
    if found != point.plant_hash:
        raise ForeignWorkerError(
            f"worker {_host()} builds plant {found} where the sweep has {point.plant_hash}; its"
            " model files differ"
        )


def _with_run(point: Point, recording: Recording, begin: float) -> PointResult:
    outcome, home = recording.info.outcome, np.array(point.scenario.platform.home)
    return PointResult(
        number=point.number,
        run_id=point.run_id,
        outcome=outcome,
        reason="" if outcome == Outcome.COMPLETED else recording.info.events[-1].message,
        duration=_duration(recording),
        emulation_error=_errors(recording, home),
        tracking_error=_tracking(recording, home) if tells_tracking(point.scenario) else {},
        run_hash=run_hash(recording),
        seconds=perf_counter() - begin,
        host=_host(),
    )


def _without_run(point: Point, outcome: str, reason: str) -> PointResult:
    return PointResult(
        number=point.number, run_id=point.run_id, outcome=outcome, reason=reason, host=_host()
    )


def _duration(recording: Recording) -> float:
    """Simulated time at the end [s]: that of the event that ended the run."""
    return max(recording.info.events[-1].time, 0.0)


def _errors(recording: Recording, home: np.ndarray) -> dict[str, AxisResult]:
    if IDEAL not in recording.signals:
        return {}
    rows = (recording["truth.pose"], recording[IDEAL], recording[LEG_LAG])
    return {
        axis: AxisResult(
            rms=error.rms, peak=error.peak, relative=error.relative, rms_rest=error.rms_rest
        )
        for axis, error in emulation_error([rows], home).items()
    }


def _tracking(recording: Recording, home: np.ndarray) -> dict[str, TrackingResult]:
    rows = (recording["truth.pose"], recording["platform.command"])
    found = tracking_error([rows], home)
    return {axis: TrackingResult(**asdict(error)) for axis, error in found.items()}


def _host() -> str:
    return f"{platform.node()}:{os.getpid()}"
