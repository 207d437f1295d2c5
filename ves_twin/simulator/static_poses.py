"""hold_poses: the rig stands at pose after pose under position control and is read there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import check_reach
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import belief_of, build_computers
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.codes import RUNNING, WRENCH_OUT_OF_RANGE
from ves_twin.simulator.noise import NoiseStreams
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.settle import stand
from ves_twin.simulator.signal_bus import WIDTH


@dataclass(frozen=True)
class HoldTimes:
    """How long each pose takes.

    Attributes:
        settle: under control before the reading begins [s].
        average: over which signals, leg lengths and joints are averaged [s].
        spacing: from one pose to the next [s]; the way between them is not simulated, but drift
            and slow noise of the sensor go on.
    """

    settle: float
    average: float
    spacing: float


@dataclass(frozen=True)
class StaticPoses:
    """What was read; one row a pose.

    Attributes:
        pose: platform pose that has the measured leg lengths [m, rad] (n, 6).
        q: measured joint angles [rad] (n, 3).
        signal: of the force sensor before calibration and zero [N, N m] (n, 6).
    """

    pose: FloatArray
    q: FloatArray
    signal: FloatArray


def hold_poses(
    scenario: Scenario,
    plant: Plant,
    poses: FloatArray,
    q: FloatArray,
    times: HoldTimes,
    seed: int = 0,
    first: int = 0,
    progress: Callable[[float], None] = lambda share: None,
) -> StaticPoses:
    """Stand at every pose and read sensor, legs and joints.

    Args:
        scenario: belief, leg loops and rates; its start pose and arm angles are not used.
        plant: the world.
        poses: platform poses from home [m, rad] (n, 6).
        q: joint angles [rad] (n, 3).
        times: how long each pose takes.
        seed: of the noise.
        first: number of the first pose in the experiment, for drift and noise.
        progress: called with the share done.

    Raises:
        UnreachableError: a pose outside the legs' travel.
        InvalidInputError: a pose at which the sensor saturates or the rig cannot stand.
    """
    belief = belief_of(scenario)
    for k, pose in enumerate(poses):
        check_reach(belief.geometry, pose, belief.leg_travel, f"pose {k + 1}")
    clock = Clock.of(scenario, plant.parameters)
    rig = Rig(plant, clock, scenario.legs, belief, NoiseStreams(seed, scenario.run.noise))
    cycle = clock.admittance * clock.tick
    averaged = max(1, round(times.average / cycle))
    cycles = max(1, round(times.settle / cycle)) + averaged
    log = np.zeros((2, WIDTH + 1))
    held = StaticPoses(
        np.empty((len(poses), 6)), np.empty((len(poses), 3)), np.empty((len(poses), 6))
    )
    for k, (pose, angles) in enumerate(zip(poses, q, strict=True)):
        computers = build_computers(_at(scenario, pose, angles), belief, rig)
        rig.tick = round((first + k) * times.spacing / cycle) * clock.admittance
        stood = stand(rig, computers, pose, angles, (cycles, averaged), log)
        if stood.code != RUNNING:
            raise _refusal(k, stood.code)
        held.pose[k] = belief.geometry.pose(stood.leg_length, pose)
        held.q[k], held.signal[k] = stood.arm_q, stood.signal
        progress((k + 1) / len(poses))
    return held


def _at(scenario: Scenario, pose: FloatArray, q: FloatArray) -> Scenario:
    """The scenario at rest at a pose."""
    platform = scenario.platform.model_copy(update={"start": tuple(pose), "motion": None})
    arm = scenario.arm.model_copy(update={"start": tuple(q), "moves": (), "path": None})
    return scenario.model_copy(update={"platform": platform, "arm": arm})


def _refusal(number: int, code: int) -> InvalidInputError:
    if code == WRENCH_OUT_OF_RANGE:
        return InvalidInputError(
            f"pose {number + 1}", "a saturated force sensor", "a wrench within sensor.range"
        )
    return InvalidInputError(f"pose {number + 1}", "a rig that does not stand", "a stable loop")
