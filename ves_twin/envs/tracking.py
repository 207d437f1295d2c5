"""PlatformTracking: follow a six-axis reference by leg set-points, whatever the rig does to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import POSE_LIMIT, POSE_UNITS
from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.commanded_legs import CommandedLegs
from ves_twin.envs.leg_channels import distance, leg_channels, leg_readings
from ves_twin.envs.priors import legs_prior
from ves_twin.envs.rig_env import RigEnv
from ves_twin.envs.true_state import true_state
from ves_twin.mechanics.joint_motion import PlatformMotion, Sine
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import NoSink
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.simulator import Simulator

if TYPE_CHECKING:
    from control import StateSpace

OFFSET = 0.03
"""Offset of a leg's set-point of a share of 1 [m]; the reference's own lag is about 0.01."""

AMPLITUDE = np.array([0.05, 0.05, 0.04, 0.07, 0.07, 0.10])
"""Largest amplitude of a reference [m, rad]; of position_sine. Drawn from 0.3 to 1 times that."""

FREQUENCY = 0.15, 0.5
"""Frequencies are drawn between these [Hz]; the legs' bandwidth is about 2."""

FADE = 2.0
"""Time in which the reference grows to its amplitude [s]."""


@final
class PlatformTracking(RigEnv[CommandedLegs]):
    """Reward: minus the distance to the reference in mm, integrated over the step [mm s].

    The distance is sqrt(|translation|^2 + (0.3 m)^2 |angles|^2) of the true pose. Actions are
    offsets of the leg set-points from the reference's own leg lengths, so that zero is position
    control. A reference of six sines is drawn for each episode, or given as a `PlatformMotion`.
    """

    SCENARIO: ClassVar[str] = "platform_tracking"
    WORST: ClassVar[float] = 100.0

    def check(self, scenario: Scenario) -> None:
        """Position mode.

        Raises:
            InvalidInputError: another mode.
        """
        if scenario.platform.mode != "position":
            mode = f"mode '{scenario.platform.mode}'"
            raise InvalidInputError(f"scenario {scenario.name}", mode, "mode 'position'")

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """Pose, legs, valves, sensor, supply, and the reference with its rate."""
        observed = Channels(
            *leg_channels(scenario),
            Channel.within("reference.pose", POSE_UNITS, POSE_LIMIT, "where to be now"),
            Channel.within(
                "reference.ahead", POSE_UNITS, POSE_LIMIT, "where to be one step from now"
            ),
        )
        offsets = Channels(
            Channel.within("leg.offset", ("m",) * 6, OFFSET, "beside the reference's leg lengths")
        )
        return observed, offsets

    def draw(self, scenario: Scenario, goal: object) -> tuple[Scenario, object]:
        """A reference: the goal, or six sines about the start pose.

        Raises:
            InvalidInputError: a goal that is not a PlatformMotion.
        """
        start = np.array(scenario.platform.start)
        if goal is None:
            size = AMPLITUDE * self.np_random.uniform(0.3, 1.0, 6)
            frequency = self.np_random.uniform(*FREQUENCY, 6)
            phase = self.np_random.uniform(0.0, 2.0 * np.pi, 6)
            goal = Sine(start, size, frequency, phase, FADE)
        elif not isinstance(goal, PlatformMotion):
            raise InvalidInputError("goal", goal, "a PlatformMotion, for instance control.Sine")
        return scenario, goal

    def build(self, plant: Plant, scenario: Scenario) -> tuple[Simulator, CommandedLegs]:
        """A simulator whose legs follow the environment."""
        sim = Simulator(plant, scenario, sink=NoSink(), controller=CommandedLegs)
        hand = sim.computers.controller
        if not isinstance(hand, CommandedLegs):
            raise TypeError("the simulator built another controller")
        return sim, hand

    def start(self, goal: PlatformMotion) -> None:
        """Begin with a reference."""
        self.hand.hold()
        self.hand.motion = goal
        self._motion, self._square, self._peak, self._cycles = goal, 0.0, 0.0, 0
        self._reference = goal.pose(self.sim.time)
        self._away = distance(true_state(self.sim.rig)[0], self._reference)

    def command(self, action: FloatArray, span: float) -> None:
        """Offsets [m] (6,) to reach at the end of the step."""
        self.hand.command(action, self.sim.time, span)

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Distances to the reference [mm]."""
        references = self._motion.along(times)
        away = [distance(pose, row) for pose, row in zip(poses, references, strict=True)]
        self._reference = references[-1]
        self._away = away[-1]
        self._square += sum(distance**2 for distance in away)
        self._peak = max(self._peak, *away)
        self._cycles += len(away)
        return sum(away)

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements, set-points, reference."""
        return {
            **leg_readings(board, self.measured_pose, self._costs.home_lengths),
            "reference.pose": self._reference,
            "reference.ahead": self._motion.pose(self.sim.time + self.span),
        }

    def truth(self) -> dict[str, FloatArray | float]:
        """Distance to the reference [mm]."""
        return {"distance": self._away}

    def metrics(self) -> dict[str, float]:
        """Rms and peak of the distance to the reference [mm]."""
        rms = float(np.sqrt(self._square / max(self._cycles, 1)))
        return {"distance_rms": rms, "distance_peak": self._peak}

    def prior(self) -> StateSpace:
        """Six legs, each a first-order loop behind its valve."""
        return legs_prior(self._scenario, OFFSET)
