"""GravityCompensation: find the weight of an unknown payload while the rig emulates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import (
    JOINT_UNITS,
    POSE_LIMIT,
    POSE_UNITS,
    WRENCH_UNITS,
    time_left,
)
from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.corrected_gravity import CorrectedGravity
from ves_twin.envs.rig_env import RigEnv
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import NoSink
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.simulator import Simulator
from ves_twin.simulator.truth_port import GravityTruth

CORRECTION = np.array([50.0, 50.0, 50.0, 60.0, 60.0, 60.0])
"""Correction of a share of 1 [N, N m]; 4 kg at a stretched arm weigh 39 N with 40 N m."""

FORCE, MOMENT = 10.0, 10.0
"""Errors that lose 1 /s [N, N m]: a kilogram, and a kilogram a metre aside."""


@final
class GravityCompensation(RigEnv[CorrectedGravity]):
    """Loss per second: |force error| / 10 N + |moment error| / 10 N m of the gravity estimate.

    The error is that of the estimate in force less the true weight of all above the sensor, in
    sensor axes. Actions are a wrench that is added to the computers' own estimate from the next
    cycle on; zero is their estimate. The arm moves by the scenario's programme, the platform
    emulates with what is estimated. A tool of unknown mass is drawn for each episode.
    """

    SCENARIO: ClassVar[str] = "gravity_compensation"
    WORST: ClassVar[float] = 20.0
    HIDDEN: ClassVar[str] = "payloads-v0"

    def check(self, scenario: Scenario) -> None:
        """Gravity is estimated, and no zeroing hides it.

        Raises:
            InvalidInputError: a scenario that does otherwise.
        """
        gravity, name = scenario.gravity, f"scenario {scenario.name}"
        if gravity.method not in ("model", "learned") or gravity.zero:
            what = f"method '{gravity.method}', zero {str(gravity.zero).lower()}"
            raise InvalidInputError(name, what, "gravity.method 'model' and zero = false")
        if scenario.platform.emulated is None:
            raise InvalidInputError(name, "no platform.emulated", "an emulated base")

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """Pose, wrench, estimate, joints, the correction in force."""
        wrench = Plant.load(scenario.belief).parameters.array("sensor.range")
        correction = Channel.within(
            "gravity.correction", WRENCH_UNITS, CORRECTION, "added to the estimate"
        )
        observed = Channels(
            Channel.within(
                "platform.pose", POSE_UNITS, POSE_LIMIT, "pose from home by the leg lengths"
            ),
            Channel.within(
                "sensor.wrench", WRENCH_UNITS, wrench, "payload on platform, sensor axes"
            ),
            Channel.within("gravity.estimate", WRENCH_UNITS, wrench, "its gravity part, corrected"),
            Channel.within("arm.q", JOINT_UNITS, np.pi, "joint angles by the encoders"),
            correction,
            time_left(scenario),
        )
        return observed, Channels(correction)

    def build(self, plant: Plant, scenario: Scenario) -> tuple[Simulator, CorrectedGravity]:
        """A simulator whose estimate the environment corrects."""
        sim = Simulator(plant, scenario, sink=NoSink())
        hand = CorrectedGravity(sim.computers.gravity)
        sim.computers.gravity = hand
        return sim, hand

    def start(self, goal: Any) -> None:
        """Begin with the computers' own estimate."""
        self.hand.correction = np.zeros(6)
        rig = self.sim.rig
        self._truth = GravityTruth(rig.model, rig.data, rig.layout)
        self._force, self._moment = self._errors()
        self._sum, self._count = np.zeros(2), 0

    def command(self, action: FloatArray, span: float) -> None:
        """A wrench [N, N m] (6,)."""
        self.hand.correction = action.copy()

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Errors at the end of the step, for each of its cycles."""
        self._force, self._moment = self._errors()
        self._sum += np.array([self._force, self._moment]) * len(times)
        self._count += len(times)
        return (self._force / FORCE + self._moment / MOMENT) * len(times)

    def _errors(self) -> tuple[float, float]:
        """Of force [N] and moment [N m]."""
        error = self.sim.rig.board["gravity.estimate"] - self._truth.gravity_in_sensor()
        return float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:]))

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements and the correction in force."""
        names = ("sensor.wrench", "gravity.estimate", "arm.q")
        return {
            "platform.pose": self.measured_pose,
            **{name: board[name] for name in names},
            "gravity.correction": self.hand.correction,
            "time.left": np.array([self.left]),
        }

    def truth(self) -> dict[str, FloatArray | float]:
        """Errors of the estimate [N, N m]."""
        return {"force_error": self._force, "moment_error": self._moment}

    def metrics(self) -> dict[str, float]:
        """Means and last values of the errors [N, N m]."""
        force, moment = (self._sum / max(self._count, 1)).tolist()
        return {
            "force_error": force,
            "moment_error": moment,
            "force_error_last": self._force,
            "moment_error_last": self._moment,
        }
