"""PositionController: position mode, the platform follows a motion."""

from __future__ import annotations

from typing import final

from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.platform_law import KNOWN_LAW
from ves_twin.control.readings import Readings
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import Hold, PlatformMotion


@final
class PositionController(PlatformController):
    """Commands the pose of a motion, open loop above the legs (thesis 2.2)."""

    law = KNOWN_LAW

    def __init__(self, motion: PlatformMotion) -> None:
        self._motion = motion

    @classmethod
    def build(cls, task: ControlTask) -> PositionController:
        """Follow the task's motion, or hold its start pose."""
        return cls(task.motion or Hold(task.start))

    def update(self, time: float, readings: Readings) -> FloatArray:
        """The motion's pose at this time."""
        return self._motion.pose(time)

    def snapshot(self) -> object:
        """Nothing changes from cycle to cycle."""
        return None

    def restore(self, snapshot: object) -> None:
        """Nothing to go back to."""
