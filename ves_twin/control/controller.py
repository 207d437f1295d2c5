"""PlatformController: decides the pose of the platform once a cycle, from readings alone."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.readings import Readings
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.joint_motion import PlatformMotion


@dataclass(frozen=True)
class ControlTask(ReadOnly):
    """What a platform controller is told when it is built.

    Attributes:
        belief: what it takes the rig to be.
        period: time between two cycles [s].
        start: pose at which it starts, at rest [m, rad] (6,).
        home: pose of the platform at which the emulated base is at zero (6,).
        emulated: the system to emulate, if any.
        motion: the motion asked for, if any.
        subtract_gravity: whether the gravity estimate is taken off the reading.
    """

    belief: Belief
    period: float
    start: FloatArray
    home: FloatArray
    emulated: EmulatedSystem | None
    motion: PlatformMotion | None
    subtract_gravity: bool


class PlatformController(abc.ABC):
    """One decision a cycle: readings in, platform pose out."""

    @property
    def law(self) -> Block | None:
        """LAW of `platform_law`, live, where the compiled cycle does the same; see `law_of`."""
        return None

    @classmethod
    @abc.abstractmethod
    def build(cls, task: ControlTask) -> PlatformController:
        """A controller for a task; raises InvalidInputError where the task lacks something."""

    @abc.abstractmethod
    def update(self, time: float, readings: Readings) -> FloatArray:
        """The pose to command now.

        Args:
            time: time since the start of the run [s].
            readings: measurements at this cycle.

        Returns:
            Platform pose from home [m, rad] (6,).
        """

    def ahead(self, times: Sequence[float], readings: Readings) -> FloatArray:
        """Poses (n, 6) at coming times [s]; asked where `law` says that no reading matters."""
        return np.array([self.update(time, readings) for time in times])

    @abc.abstractmethod
    def snapshot(self) -> object:
        """A copy of everything that changes from cycle to cycle."""

    @abc.abstractmethod
    def restore(self, snapshot: object) -> None:
        """Go back to a snapshot."""
