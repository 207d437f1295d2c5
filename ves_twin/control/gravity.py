"""GravityCompensation: estimates the gravity wrench that the sensor reads."""

from __future__ import annotations

import abc
from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.readings import Readings
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.learned import LearnedGravity
from ves_twin.mechanics.gravity.quick_gravity import QuickGravity


class TruthPort(Protocol):
    """The door through which a perfect compensation, and nothing else, sees the plant."""

    def gravity_in_sensor(self) -> FloatArray:
        """True gravity wrench of the payload, sensor axes [N, N m] (6,)."""
        ...


@dataclass(frozen=True)
class GravityTask:
    """What a compensation is told when it is built.

    Attributes:
        belief: what the computers take the rig to be.
        truth: for tests alone.
        learned: W_g of the Learning Method, where the scenario names one.
    """

    belief: Belief
    truth: TruthPort
    learned: LearnedGravity | None = None


class GravityCompensation(abc.ABC):
    """One estimate a cycle."""

    subtracts: bool = True
    """Whether the estimate is taken off the reading; False leaves the reading as it is."""

    @abc.abstractmethod
    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Gravity wrench of the payload on the platform, sensor axes [N, N m] (6,)."""

    @abc.abstractmethod
    def snapshot(self) -> object:
        """A copy of what changes from cycle to cycle."""

    @abc.abstractmethod
    def restore(self, snapshot: object) -> None:
        """Go back to a snapshot."""


class _Stateless(GravityCompensation):
    def snapshot(self) -> object:
        """Nothing changes from cycle to cycle."""
        return None

    def restore(self, snapshot: object) -> None:
        """Nothing to go back to."""


@final
class NoCompensation(_Stateless):
    """Nothing is subtracted: what weight the zeroing has not tared pushes the emulated base."""

    subtracts = False

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Zero."""
        return np.zeros(6)


@final
class TruthCompensation(_Stateless):
    """The plant's own gravity wrench, for tests: no laboratory has it."""

    def __init__(self, port: TruthPort) -> None:
        self._port = port

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """The true gravity wrench, as the sensor's ideal axes would read it."""
        return self._port.gravity_in_sensor()


@final
class ModelCompensation(GravityCompensation):
    """The Model Method: M_total and P with measured joints and measured platform orientation.

    The orientation is that of the pose which has the measured leg lengths.

    Source: thesis 3.4, eqs 3.3, 3.9, D.1.
    """

    def __init__(self, belief: Belief) -> None:
        self._geometry, self._model = belief.geometry, QuickGravity.of(belief.gravity)
        self._position = np.array(belief.sensor_position)
        self._pose = np.zeros(6)

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Predicted gravity wrench at the measured joints and platform pose."""
        self._pose = self._geometry.pose(readings.leg_length, self._pose)
        return self._model.wrench_in_sensor(readings.arm_q, self._pose[3:], self._position)

    def snapshot(self) -> object:
        """The pose from which the next solution starts (6,)."""
        return self._pose.copy()

    def restore(self, snapshot: object) -> None:
        """Set the pose from which the next solution starts."""
        self._pose = np.array(snapshot, dtype=float)
