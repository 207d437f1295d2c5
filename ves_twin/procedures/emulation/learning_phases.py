"""LearningPhases: the two phases of an iteration of the Learning Method, on the rig."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ves_twin.control.played import PlayedJoints, PlayedPoses, PlayedWrench, Script
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.learned import LearnedGravity, PlannedExperiment
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Progress
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.arm_commands import arm_motion
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.planned import planned_experiment
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.simulate import SLICE, recording_info, simulate
from ves_twin.simulator.simulator import Simulator

CUBIC = 3
"""Order of the local polynomials that smooth W_g: they leave its slope and curvature alone."""


Changes = Mapping[str, Mapping[str, Any]]
"""Table of a scenario -> keys of it that are changed."""


@dataclass(frozen=True)
class LearningPhases:
    """One experiment, as it is run slowly and at full speed.

    Attributes:
        scenario: the experiment at full speed.
        plant: the world.
        alpha: how much slower phase A is.
        smooth: length of the local fit of W_g, in the time of the full-speed motion [s].
    """

    scenario: Scenario
    plant: Plant
    alpha: float
    smooth: float

    @property
    def planned(self) -> PlannedExperiment:
        """What W_g belongs to; raises InvalidInputError where nothing can be learned."""
        return planned_experiment(self.scenario, self.plant)

    def slow(self, motion: FloatArray, seed: int, progress: Progress) -> Recording:
        """Phase A: q(t / alpha) and a platform motion under position control.

        Args:
            motion: platform poses at the cycles of the full-speed motion [m, rad] (n, 6).
            seed: of the noise.
            progress: told the share done.

        Returns:
            The recording, whose sensor was zeroed (tared) where the motion starts.
        """
        planned = self.planned
        period, count = planned.period, len(motion)
        cycles = int(np.ceil((count - 1) * self.alpha)) + 1
        times = np.arange(cycles) * period
        s = np.minimum(times / self.alpha, (count - 1) * period)
        at = np.arange(count) * period
        poses = np.column_stack([np.interp(s, at, column) for column in motion.T])
        joints = arm_motion(self.scenario)
        script = Script(
            PlayedPoses(poses, period),
            PlayedJoints(np.array([joints.q(t) for t in s]), period),
            PlayedWrench(np.zeros((1, 6)), period),
        )
        scenario = self._slow_scenario(cycles * period)
        sim = Simulator(self.plant, scenario, seed, MemorySink(), script)
        return _recorded(sim, lambda share: progress(share, "phase A, slow"))

    def gravity(self, slow: Recording) -> FloatArray:
        """W_g at the cycles of the full-speed motion [N, N m] (n, 6), from the slow recording.

        A cycle of the motion takes alpha cycles of phase A. Local cubics over `smooth` take their
        noise, and what the steps of the commands shake, off: sd down to sqrt(9 / (4 m)) for
        m independent rows (Savitzky-Golay), without lag.
        """
        from scipy.signal import savgol_filter  # slow to import

        period = self.planned.period
        rows = min(round(self.smooth * self.alpha / period), len(slow) - 1)
        window = max(rows | 1, CUBIC + 2)
        fitted = savgol_filter(slow["sensor.wrench"], window, CUBIC, axis=0)
        count = len(self.planned.commands)
        at = np.minimum(np.arange(count) * period * self.alpha, slow.time[-1])
        return np.column_stack([np.interp(at, slow.time, column) for column in fitted.T])

    def full_speed(
        self, wrenches: FloatArray, file: Path, source: str, seed: int, progress: Progress
    ) -> Recording:
        """Phase B: the experiment with W_g taken off the reading; W_g goes into the file."""
        LearnedGravity(wrenches, self.planned, source).save(file)
        gravity = {"method": "learned", "file": str(file)}
        return self.run({"gravity": gravity}, seed, progress, "phase B, full speed")

    def run(
        self, changes: Changes, seed: int, progress: Progress, what: str = "full speed"
    ) -> Recording:
        """The experiment at full speed with some tables of the scenario changed."""
        content = self.scenario.model_dump(mode="json")
        for key, table in changes.items():
            content[key] |= table
        length = self.scenario.run.duration
        return simulate(
            Scenario.model_validate(content),
            self.plant,
            seed,
            lambda time: progress(min(time / length, 1.0), what),
        )

    def _slow_scenario(self, duration: float) -> Scenario:
        content = self.scenario.model_dump(mode="json")
        content["run"] |= {"duration": duration, "log": "admittance"}
        content["platform"] |= {"mode": "position", "emulated": None, "busy": []}
        content["gravity"] = {"method": "none"}
        content["arm"]["moves"] = []
        return Scenario.model_validate(content)


def poses_at_cycles(run: Recording, planned: PlannedExperiment) -> FloatArray:
    """The platform's measured pose at the cycles of a run [m, rad] (n, 6).

    The measured pose, not the commanded one: gravity acts where the platform is, and at full
    speed it trails its command by the legs' bandwidth.

    Raises:
        VesTwinError: the run has fewer rows than the experiment has cycles.
    """
    due = (np.arange(len(planned.commands)) + 0.25) * planned.period  # round-off of the times
    if run.time[-1] < due[-1] - planned.period:
        raise VesTwinError(f"the run ended at {run.time[-1]:.3f} s, before the experiment did")
    return np.array(run["platform.pose"][np.searchsorted(run.time, due, "right") - 1])


def _recorded(sim: Simulator, progress: Callable[[float], None]) -> Recording:
    length = sim.scenario.run.duration
    try:
        while not sim.done:
            sim.advance(SLICE)
            progress(min(sim.time / length, 1.0))
    except KeyboardInterrupt:
        if sim.outcome is None:
            sim.end(Outcome.INTERRUPTED, f"stopped from the keyboard at {sim.time:.3f} s")
    time, signals = sim.recorder.collect()
    return Recording(time, signals, recording_info(sim))
