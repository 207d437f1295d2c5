"""GravityCompensation: estimates the gravity wrench that the sensor reads."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.gravity_law import KNOWN_LAW, model_law, model_wrench
from ves_twin.control.readings import Readings
from ves_twin.core.types import Block, FloatArray
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

    @property
    def law(self) -> Block | None:
        """LAW of `gravity_law`, live, where the compiled cycle does the same; see `law_of`."""
        return None

    subtracts: bool = True
    """Whether the estimate is taken off the reading; False leaves the reading as it is."""

    @abc.abstractmethod
    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Gravity wrench of the payload on the platform, sensor axes [N, N m] (6,)."""

    def ahead(self, times: Sequence[float], readings: Readings) -> FloatArray:
        """Estimates (n, 6) at coming times [s]; asked where `law` says that no reading matters."""
        return np.array([self.wrench(time, readings) for time in times])

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
    law = KNOWN_LAW

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Zero."""
        return np.zeros(6)


@final
class TruthCompensation(_Stateless):
    """The plant's own gravity wrench, for tests: no laboratory has it."""

    def __init__(self, port: TruthPort) -> None:
        self._port = port
        law: Block | None = getattr(port, "law", None)
        self._law = None if law is None else law.copy()

    @property
    def law(self) -> Block | None:
        """The port's, if it has one: the compiled cycle then looks at the plant itself."""
        return self._law

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
        self._geometry = belief.geometry
        self._law = model_law(QuickGravity.of(belief.gravity), belief.sensor_position)

    @property
    def law(self) -> Block:
        """Numbers and the pose from which the next solution starts, live."""
        return self._law

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Predicted gravity wrench at the measured joints and platform pose."""
        pose = self._geometry.pose(readings.leg_length, self._law["pose"][0])
        self._law["pose"] = pose
        return model_wrench(self._law, readings.arm_q, pose[3:])

    def snapshot(self) -> object:
        """The pose from which the next solution starts (6,)."""
        return self._law["pose"][0].copy()

    def restore(self, snapshot: object) -> None:
        """Set the pose from which the next solution starts."""
        self._law["pose"] = snapshot
