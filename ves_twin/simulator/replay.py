"""replay: feed the set-points of a recording to a plant, and see what it would have measured."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ves_twin.control.played import PlayedJoints, PlayedPoses, PlayedWrench, Script, spline_points
from ves_twin.core.errors import EndedEarlyError, InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.setpoint_motion import poses_of
from ves_twin.simulator.simulate import recording_info
from ves_twin.simulator.simulator import Simulator

DRIVABLE = ("leg.command", "platform.command", "arm.command", "gravity.estimate")
"""What can be fed in: set-points, and the estimate that the sensor is zeroed against."""

MEASUREMENTS = (*(n for n, s in SIGNALS.items() if s.role is Role.MEASUREMENT), "valve.command")
"""What comes back if nothing is asked for: what the rig answers to its set-points."""

NEAR = 1e-3
"""How far the first set-point may lie from the scenario's start [m, rad]: motion of one cycle."""

COMPARABLE = tuple(n for n, s in SIGNALS.items() if s.role is not Role.REFERENCE)


def replay(
    recording: Recording,
    plant: Plant,
    drive: Sequence[str] = ("leg.command", "arm.command", "gravity.estimate"),
    compare: Sequence[str] = MEASUREMENTS,
    scenario: Scenario | None = None,
) -> Recording:
    """What a plant would have measured with the set-points of a recording, without noise.

    The loop is cut above the legs: commanded lengths and joint angles go in, so that two plants
    differ by their hardware and not by what an outer loop makes of it. Leg loops, joint servo
    and sensor chain run as the scenario deploys them; the rig settles at the first set-point. Its
    first cycle begins at the first row, wherever that lies in time: a window of a run replays.

    Args:
        recording: the run, simulated or measured, its rows on the log clock of the scenario.
        plant: the rig that is tried, with its effects.
        drive: signals that are fed in; without the arm's command the arm stands.
        compare: signals that come back.
        scenario: rates, leg gains and start of the arm; the recording's own if left out.

    Returns:
        The signals of `compare` on the recording's rows.

    Raises:
        UnknownNameError: a signal that cannot be fed in or compared, or that is missing.
        InvalidInputError: no set-points for the legs, no scenario to go by, no rows, or rows that
            are not those of the scenario's log clock (`run.log`).
        EndedEarlyError: the run ended early; says how.
    """
    for name in drive:
        if name not in DRIVABLE:
            raise UnknownNameError("signal to feed in", name, DRIVABLE)
    for name in compare:
        if name not in COMPARABLE:
            raise UnknownNameError("signal to compare", name, COMPARABLE)
    if not len(recording):
        raise InvalidInputError("recording", "0 rows", "one or more")
    fed = replace(recording, time=recording.time - recording.time[0])
    played = replay_scenario(fed, scenario)
    script = Rows(fed, played).script(drive, played)
    played = _starting_at(played, script)
    sim = Simulator(plant, played, 0, MemorySink(), script=script)
    _check_rows(fed, sim)
    while not sim.done:
        sim.advance(played.run.duration)
    return _collected(sim, recording, compare)


def replay_scenario(recording: Recording, scenario: Scenario | None = None) -> Scenario:
    """A scenario as a position run as long as a recording, noise and effects left to the plant.

    Raises:
        InvalidInputError: neither a scenario nor one in the recording's metadata.
    """
    content: dict[str, Any] = (
        json.loads(recording.info.settings)
        if scenario is None
        else scenario.model_dump(mode="json")
    )
    if not content:
        raise InvalidInputError(
            "recording", "no scenario in its metadata", "one, or a scenario to go by"
        )
    period = float(np.median(np.diff(recording.time))) if len(recording) > 1 else 1.0
    content["run"] |= {"duration": float(recording.time[-1]) + 0.5 * period, "noise": False}
    content["platform"] |= {"mode": "position", "emulated": None, "motion": None, "busy": []}
    model = content["gravity"]["method"] == "model"
    file = content["gravity"]["file"] if model else None  # the sensor keeps its calibration
    content["gravity"] |= {"method": "none", "file": None}
    content |= {"parameters": {}, "effects": {}}
    replayed = Scenario.model_validate(content)
    gravity = replayed.gravity.model_copy(update={"file": file})
    return replayed.model_copy(update={"gravity": gravity})


class Rows:
    """The rows of a recording at the admittance cycles of a scenario.

    Args:
        recording: signals held from row to row.
        scenario: gives the rate and what the computers believe.
    """

    def __init__(self, recording: Recording, scenario: Scenario) -> None:
        belief = belief_of(scenario)
        self._recording = recording
        self._geometry: StewartGeometry = belief.geometry
        tick = Plant.load(scenario.belief).parameters.number("clock.tick")
        self.period = max(1, round(1.0 / (scenario.platform.rate * tick))) * tick
        count = round(float(recording.time[-1]) / self.period) + 1
        due = np.arange(count) * self.period + 0.25 * tick  # round-off of the recorded times
        self._at = np.maximum(np.searchsorted(recording.time, due, "right") - 1, 0)

    def signal(self, name: str) -> FloatArray:
        """A signal at the cycles (n, width)."""
        return np.array(self._recording[name][self._at])

    def script(self, drive: Sequence[str], scenario: Scenario) -> Script:
        """What the computers play back.

        Raises:
            InvalidInputError: no set-points for the legs.
        """
        if "leg.command" in drive:
            lengths = np.ascontiguousarray(self.signal("leg.command"))
            poses = poses_of(lengths, np.array(scenario.platform.start), self._geometry)
        elif "platform.command" in drive:
            poses = self.signal("platform.command")
        else:
            raise InvalidInputError("drive", list(drive), "leg.command or platform.command")
        points = np.array([scenario.arm.start], dtype=float)
        if "arm.command" in drive:
            points = spline_points(self.signal("arm.command"))
        wrenches = np.zeros((1, 6))
        if "gravity.estimate" in drive:
            wrenches = self.signal("gravity.estimate")
        return Script(
            PlayedPoses(poses, self.period),
            PlayedJoints(points, self.period),
            PlayedWrench(wrenches, self.period),
        )


def _starting_at(scenario: Scenario, script: Script) -> Scenario:
    """The rig settles at the scenario's start, or at the first set-points if they lie elsewhere.

    A window of a run begins elsewhere; a whole run's first command is a cycle after its start.
    """
    pose, joints = script.poses.pose(0.0), script.joints.q(0.0)
    if np.abs(pose - scenario.platform.start).max() < NEAR:
        pose = np.array(scenario.platform.start)
    if np.abs(joints - scenario.arm.start).max() < NEAR:
        joints = np.array(scenario.arm.start)
    platform = scenario.platform.model_copy(update={"start": tuple(map(float, pose))})
    arm = scenario.arm.model_copy(
        update={"start": tuple(map(float, joints)), "moves": (), "path": None}
    )
    return scenario.model_copy(update={"platform": platform, "arm": arm})


def _check_rows(recording: Recording, sim: Simulator) -> None:
    """Refuse rows at other times than those that the simulator logs."""
    clock, time = sim.rig.clock, recording.time
    step = clock.log * clock.tick
    off = np.abs(time - np.arange(len(time)) * step) > clock.tick
    if np.any(off):
        row = int(np.argmax(off))
        log = f"every {step:.6g} s, the log clock '{sim.scenario.run.log}'"
        came = f"row {row + 1} at {time[row]:.6g} s after the first"
        raise InvalidInputError("recording", came, f"rows {log}; resample it, or set run.log")


def _collected(sim: Simulator, recording: Recording, compare: Sequence[str]) -> Recording:
    time, signals = sim.recorder.collect()
    if len(time) < len(recording):
        why = sim.events[-1].message if sim.events else "no event"
        raise EndedEarlyError(
            f"the replay ended after {len(time)} of {len(recording)} rows ({sim.outcome}: {why})"
        )
    kept = {name: signals[name][: len(recording)] for name in compare}
    return Recording(np.array(recording.time), kept, recording_info(sim))
