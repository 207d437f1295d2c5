"""GravityCompensation: estimates the gravity wrench that the sensor reads."""

from __future__ import annotations

import abc
from typing import Protocol, final

import numpy as np

from ves_twin.control.readings import Readings
from ves_twin.types import FloatArray


class TruthPort(Protocol):
    """The door through which a perfect compensation, and nothing else, sees the plant."""

    def gravity_in_sensor(self) -> FloatArray:
        """True gravity wrench of the payload, sensor axes [N, N m] (6,)."""
        ...


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
