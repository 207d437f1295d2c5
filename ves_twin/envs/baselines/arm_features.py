"""ArmFeatures: what a trained policy of the arm is shown, in shares of usual sizes."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import TaskSpec

SIZES = np.array(
    [0.05] * 3 + [0.05] * 3  # pose [m, rad]; a release begins at 0.1 m
    + [0.2] * 3 + [0.2] * 3  # its rate [m/s, rad/s]: 0.05 at 0.6 Hz
    + [100.0] * 3 + [100.0] * 3  # wrench less gravity [N, N m]: an arm of 30 kg at 3 m/s^2
    + [0.5] * 3  # joint set-points from the start [rad]
    + [0.5] * 3  # their rate [rad/s]
)  # fmt: skip
"""Usual size of each feature, in its unit (24,); numbers of size one are what networks learn from.
A trained network holds for these sizes alone."""


@final
class ArmFeatures:
    """Pose and its rate, dynamic wrench, set-points and their rate, each over its usual size.

    Rates are differences over a step: the readings have none. Time and goal are left out.

    Args:
        briefing: of an environment of the arm on an emulated base.

    Raises:
        InvalidInputError: another environment.
    """

    WIDTH = len(SIZES)

    def __init__(self, briefing: TaskSpec) -> None:
        columns = briefing.observations.slices
        names = ("platform.pose", "sensor.wrench", "gravity.estimate", "arm.command")
        if not {*names} <= columns.keys() or columns.keys() & {"goal", "target.position"}:
            raise InvalidInputError("features", "another task", "VesTwin/VibrationDamping-v0")
        self._pose, self._wrench, self._gravity, self._arm = (columns[name] for name in names)
        self._step = briefing.step

    def begin(self, observation: FloatArray) -> None:
        """Forget the episode before; nothing moved until the first observation."""
        self._start = self._joints = observation[self._arm].copy()
        self._last = observation[self._pose].copy()

    def of(self, observation: FloatArray) -> FloatArray:
        """The features (24,) of the next observation; called once a step."""
        pose, joints = observation[self._pose], observation[self._arm]
        found = np.concatenate(
            [
                pose,
                (pose - self._last) / self._step,
                observation[self._wrench] - observation[self._gravity],
                joints - self._start,
                (joints - self._joints) / self._step,
            ]
        )
        self._last, self._joints = pose.copy(), joints.copy()
        return np.asarray(found / SIZES)
