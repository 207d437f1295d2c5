"""MicrogravityCapture: catch a drifting target with an arm on a free-floating emulated base."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import ArmEnv, time_left
from ves_twin.envs.channels import Channel, Channels
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.signal_bus import SignalBus

WHERE = np.radians([[0.0, 15.0, -50.0], [75.0, 75.0, 0.0]])
"""Corners of the box of joint angles at whose tip a target passes [rad]."""

WHEN = 8.0
"""When it passes there [s]: half an episode."""

DRIFT = 0.02, 0.06
"""Its speed is drawn between these [m/s]; assumed: tumbling targets are approached at cm/s."""

AWAY, NEAR, MATCHED = 0.1, 0.02, 0.04
"""Distance that loses 1 /s [m]; distance [m] and relative speed [m/s] that count as caught: what
the capture range of a small gripper takes. Assumed."""


@final
class MicrogravityCapture(ArmEnv):
    """Loss per second until the target is caught: distance of the tip / 0.1 m; then none.

    Caught is: nearer than 20 mm at less than 40 mm/s. Positions are inertial, from the platform's
    home. The target passes within reach, in a straight line at a steady speed; or
    `options={"goal": (position, velocity)}` says where it is at t = 0 [m] and how fast [m/s].
    """

    SCENARIO: ClassVar[str] = "microgravity_capture"
    WORST: ClassVar[float] = 20.0

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """The arm's channels, the target, the time left."""
        observed, actions = self.arm_channels(scenario)
        target = (
            Channel.within(
                "target.position", ("m",) * 3, 3.0, "inertial, from the platform's home"
            ),
            Channel.within("target.velocity", ("m/s",) * 3, 1.0, "inertial"),
        )
        return Channels(*observed, *target, time_left(scenario)), actions

    def draw(self, scenario: Scenario, goal: object) -> tuple[Scenario, object]:
        """Where the target is at t = 0, and how fast.

        Raises:
            InvalidInputError: a goal that is not two times three finite numbers.
        """
        if goal is None:
            belief = Plant.load(scenario.belief)
            angles = np.asarray(self.np_random.uniform(*WHERE))
            passes = tip_position(belief, np.zeros(6), angles)
            direction = self.np_random.standard_normal(3)
            speed = self.np_random.uniform(*DRIFT)
            velocity = speed * direction / np.linalg.norm(direction)
            return scenario, np.array([passes - WHEN * velocity, velocity])
        try:
            given = np.array(goal, float)
        except (TypeError, ValueError):
            given = np.empty(0)
        if given.shape != (2, 3) or not np.all(np.isfinite(given)):
            raise InvalidInputError("goal", goal, "position [m] and velocity [m/s], three each")
        return scenario, given

    def start(self, goal: Any) -> None:
        """Begin with a target (2, 3)."""
        super().start(goal)
        rig = self.sim.rig
        self._tip = rig.data.site_xpos[rig.model.site("arm/tip").id]
        self._home_position = rig.parameters["home"]["position"][0]
        self._target, self._drift = goal
        self._caught: float | None = None
        self._last_tip = self._tip_now()
        self._away = float(np.linalg.norm(self._last_tip - self._target))
        self._speed = float(np.linalg.norm(self._drift))

    def _tip_now(self) -> FloatArray:
        """The true tip [m] (3,)."""
        return np.asarray(self._tip - self._home_position)

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """The distance at the end of the step, for each of its cycles, until it is caught."""
        tip, span = self._tip_now(), self._cycle * len(times)
        self._away = float(np.linalg.norm(tip - self._target - self._drift * times[-1]))
        self._speed = float(np.linalg.norm((tip - self._last_tip) / span - self._drift))
        self._last_tip = tip
        if self._caught is None and self._away < NEAR and self._speed < MATCHED:
            self._caught = times[-1]
        return 0.0 if self._caught is not None else self._away / AWAY * len(times)

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements, set-points, target."""
        return {
            **super().readings(board),
            "target.position": self._target + self._drift * self.sim.time,
            "target.velocity": self._drift,
        }

    def truth(self) -> dict[str, FloatArray | float]:
        """Distance of the tip from the target [m], relative speed [m/s]."""
        return {"distance": self._away, "relative_speed": self._speed}

    def metrics(self) -> dict[str, float]:
        """Whether and when it was caught [s], the last distance [m]."""
        duration = self.sim.scenario.run.duration
        return {
            "caught": float(self._caught is not None),
            "caught_at": duration if self._caught is None else self._caught,
            "tip_distance": self._away,
        }


def tip_position(plant: Plant, pose: FloatArray, q: FloatArray) -> FloatArray:
    """Tip [m] (3,), inertial, from home, at a pose (6,) and joint angles (3,) as described."""
    tip = plant.arm.transforms(q)[2][:3, 3]
    return np.asarray(pose[:3] + matrix_from_angles(pose[3:]) @ tip)


def tip_jacobian(plant: Plant, pose: FloatArray, q: FloatArray) -> FloatArray:
    """Its derivative with respect to the joint angles [m/rad] (3, 3), by central differences."""
    step = 1e-6
    columns = [
        tip_position(plant, pose, q + step * unit) - tip_position(plant, pose, q - step * unit)
        for unit in np.eye(3)
    ]
    return np.asarray(np.column_stack(columns) / (2.0 * step))
