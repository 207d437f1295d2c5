"""simulate: a scenario from settling to its end, as a recording in memory or in a folder."""

from __future__ import annotations

import platform as host
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

import numpy as np
import pyarrow.parquet as pq

from ves_twin.control.controller import PlatformController
from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.held_folder import HeldFolder, hold_folder
from ves_twin.core.json_text import json_text
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.effects.registry import effects_table
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.emulation_error import AxisError, emulation_error
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.recorder import IDEAL, LEG_LAG, NoSink
from ves_twin.simulator.simulator import Simulator
from ves_twin.simulator.tracking_error import TrackingError, tells_tracking, tracking_error

SUMMARY_NAME = "summary.json"
SLICE = 0.25
"""Simulated time between two calls of `progress` [s]."""

Progress = Callable[[float], None]
"""Called with the time that the run has reached [s]."""


@dataclass(frozen=True)
class Timing:
    """How fast a run was: `prepare` before t = 0, then `run`, wall-clock seconds."""

    prepare: float
    run: float
    simulated: float
    real_time_factor: float
    admittance_rate: float


@dataclass(frozen=True)
class Summary:
    """Account of a run; what `summary.json` holds.

    `emulation_error` is of runs with a zero-g reference, `tracking_error` of those that emulate
    nothing; each is by axis, and empty elsewhere.
    """

    scenario: str
    question: str
    outcome: Outcome
    advice: str
    seed: int
    plant: str
    plant_hash: str
    duration: float
    emulation_error: dict[str, AxisError]
    tracking_error: dict[str, TrackingError]
    events: list[dict[str, object]]
    timing: Timing

    def to_json(self) -> str:
        """The summary as indented JSON; what is not finite is null."""
        return json_text(asdict(self))


def simulate(
    scenario: Scenario,
    plant: Plant | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Recording:
    """Run a scenario and keep the recording in memory.

    Args:
        scenario: what is done.
        plant: the world; the scenario's own if left out.
        seed: seed of the noise; the scenario's own if left out.
        progress: called now and then with the time reached.

    Returns:
        The recording; `info.outcome` says how the run ended.

    Raises:
        VesTwinError: the scenario cannot be built, or a controller failed.
    """
    sim = Simulator(plant, scenario, seed)
    _run(sim, progress)
    time, signals = sim.recorder.collect()
    return Recording(time, signals, recording_info(sim))


def record(
    scenario: Scenario,
    folder: Path | HeldFolder,
    plant: Plant | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
    controller: type[PlatformController] | None = None,
) -> Summary:
    """Run a scenario and write `recording.parquet` and `summary.json` into a folder.

    While it runs the rows go to `recording.arrows`; whatever ends the run, they are kept.
    A `controller` decides the platform's pose in place of the one that the mode names.

    Raises:
        FileAccessError: the folder cannot be written, or another command writes it.
        VesTwinError: the scenario cannot be built, or a controller failed.
    """
    begin = perf_counter()
    sim = Simulator(plant, scenario, seed, sink=NoSink(), controller=controller)
    with hold_folder(folder) as held:
        for name in (SUMMARY_NAME, "run.rrd"):  # of an earlier run, which this one replaces
            (held.path / name).unlink(missing_ok=True)
        ready = perf_counter()
        with RecordingStream(held.path, sim.recorder.names, recording_info(sim)) as stream:
            sim.recorder.sink = stream
            try:
                _run(sim, progress)
            finally:  # rows are handed over beside: also after an interrupt in the last of it
                sim.recorder.flush(unfinished=sim.outcome is not None)
            path = stream.finish(recording_info(sim))
        summary = _summary(sim, path, ready - begin, perf_counter() - ready)
        write_whole(held.path / SUMMARY_NAME, summary.to_json() + "\n")
    return summary


def recording_info(sim: Simulator) -> RecordingInfo:
    """Where the recording of a simulator comes from, up to now."""
    clock = sim.rig.clock
    held = {}
    if clock.log < clock.admittance:
        slow = ("leg.command", "platform.command", "gravity.estimate")
        held = {name: clock.admittance * clock.tick for name in slow}
    if clock.log < clock.leg:
        held["valve.command"] = clock.leg * clock.tick
    return RecordingInfo(
        origin="simulated",
        scenario=sim.scenario.name,
        settings=sim.scenario.model_dump_json(),
        plant=sim.plant.name,
        plant_hash=sim.plant.hash,
        plant_base=sim.plant.base,
        parameters=sim.plant.changes(),
        effects=effects_table(sim.plant.effects),
        seed=sim.seed,
        versions=dict(versions()),
        log=sim.scenario.run.log,
        period=clock.log * clock.tick,
        held=held,
        outcome=sim.outcome.value if sim.outcome else "unfinished",
        events=tuple(sim.events),
    )


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Versions of everything that shapes the numbers; they do not change while a program runs."""
    packages = {name: version(name) for name in ("mujoco", "numpy", "numba", "scipy", "pyarrow")}
    return {"ves_twin": _own_version(), "python": host.python_version(), **packages}


def _own_version() -> str:
    from ves_twin import __version__

    return __version__


def _run(sim: Simulator, progress: Progress | None) -> None:
    try:
        while not sim.done:
            sim.advance(SLICE)
            if progress is not None:
                progress(sim.time)
    except KeyboardInterrupt:
        if sim.outcome is not None:
            return
        sim.end(Outcome.INTERRUPTED, f"stopped from the keyboard at {sim.time:.3f} s")


def _summary(sim: Simulator, recording: Path, prepare: float, run: float) -> Summary:
    assert sim.outcome is not None  # noqa: S101  (the run has ended)
    home = np.array(sim.scenario.platform.home)
    emulation: dict[str, AxisError] = {}
    tracking: dict[str, TrackingError] = {}
    if IDEAL in sim.recorder.names:
        three = _rows(recording, ("truth.pose", IDEAL, LEG_LAG))
        emulation = emulation_error(((truth, ideal, lag) for truth, ideal, lag in three), home)
    elif tells_tracking(sim.scenario):
        two = _rows(recording, ("truth.pose", "platform.command"))
        tracking = tracking_error(((truth, command) for truth, command in two), home)
    return Summary(
        scenario=sim.scenario.name,
        question=sim.scenario.question,
        outcome=sim.outcome,
        advice=sim.outcome.advice,
        seed=sim.seed,
        plant=sim.plant.name,
        plant_hash=sim.plant.hash,
        duration=max(sim.time, 0.0),
        emulation_error=emulation,
        tracking_error=tracking,
        events=[asdict(event) for event in sim.events],
        timing=Timing(
            prepare=prepare,
            run=run,
            simulated=sim.time,
            real_time_factor=sim.time / run if run > 0 else 0.0,
            admittance_rate=sim.rig.clock.rate,
        ),
    )


def _rows(recording: Path, names: Sequence[str]) -> Iterator[list[FloatArray]]:
    """Some signals of a Parquet file, a row group at a time."""
    groups = [SIGNALS[name].columns for name in names]
    with arrow_file(recording) as file:
        columns = [column for group in groups for column in group]
        for batch in pq.ParquetFile(file).iter_batches(columns=columns):
            yield [
                np.column_stack([batch.column(column).to_numpy() for column in group])
                for group in groups
            ]
