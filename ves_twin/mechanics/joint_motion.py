"""PlatformMotion and ArmMotion: what is asked of platform and arm over time."""

from __future__ import annotations

import abc
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray


class PlatformMotion(abc.ABC):
    """A pose over time, and over nothing else: it is asked for ahead of time."""

    @abc.abstractmethod
    def pose(self, time: float) -> FloatArray:
        """Platform pose from home [m, rad] (6,) at a time [s]; constant before zero."""

    def along(self, times: Sequence[float]) -> FloatArray:
        """Poses (n, 6) at several times [s]."""
        return np.array([self.pose(time) for time in times])


@dataclass(frozen=True)
class Hold(PlatformMotion):
    """Stand still at a pose [m, rad] (6,)."""

    at: FloatArray

    def pose(self, time: float) -> FloatArray:
        """The pose, whatever the time."""
        return self.at


@dataclass(frozen=True)
class Sine(PlatformMotion):
    """Sines about a pose, one an axis, faded in over `fade` seconds.

    Attributes:
        at: middle pose [m, rad] (6,).
        amplitude: of each axis [m, rad] (6,).
        frequency: of each axis [Hz] (6,).
        phase: of each axis [rad] (6,).
        fade: time over which the amplitude grows smoothly from zero [s].
    """

    at: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    phase: FloatArray
    fade: float

    def pose(self, time: float) -> FloatArray:
        """Middle pose plus the faded sines."""
        if time <= 0.0:
            return self.at
        envelope = quintic(time / self.fade) if self.fade > 0.0 else 1.0
        angle = 2.0 * np.pi * self.frequency * time + self.phase
        return np.asarray(self.at + envelope * self.amplitude * np.sin(angle))

    def along(self, times: Sequence[float]) -> FloatArray:
        """The same at several times, to the last bit."""
        if min(times) <= 0.0 or self.fade <= 0.0:
            return super().along(times)
        t = np.array(times)[:, None]
        envelope = np.array([quintic(time / self.fade) for time in times])[:, None]
        angle = 2.0 * np.pi * self.frequency * t + self.phase
        return np.asarray(self.at + envelope * self.amplitude * np.sin(angle))


@dataclass(frozen=True)
class Move:
    """One joint move: quintic from where the arm is to `to` [rad] (3,)."""

    start: float
    duration: float
    to: FloatArray


class JointMotion(abc.ABC):
    """Joint angles over time, and over nothing else: they are asked for ahead of time."""

    @abc.abstractmethod
    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]; constant before zero."""

    def along(self, times: Sequence[float]) -> FloatArray:
        """Joint angles [rad] (n, 3) at several times [s]."""
        return np.array([self.q(time) for time in times])


@dataclass(frozen=True)
class ArmMotion(JointMotion):
    """Joint moves one after the other; the profile of each is a quintic, at rest at both ends.

    Attributes:
        start: joint angles before the first move [rad] (3,).
        moves: in order of time, not overlapping.

    Source: thesis 3.2.1 gives 180 deg in 2 s without the profile; quintic assumed.
    """

    start: FloatArray
    moves: tuple[Move, ...]

    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]."""
        angles = self.start
        for move in self.moves:
            if time <= move.start:
                break
            if time >= move.start + move.duration:
                angles = move.to
            else:
                share = quintic((time - move.start) / move.duration)
                angles = angles + share * (move.to - angles)
        return angles


@dataclass(frozen=True)
class RecordedJoints(JointMotion):
    """Joint angles through recorded points, without overshoot (monotone cubic pieces).

    Attributes:
        times: of the points [s] (n,); the first point before them, the last after them.
        curve: joint angles [rad] (3,) at a time [s] within them.
    """

    times: FloatArray
    curve: Callable[[float], FloatArray]

    @staticmethod
    def through(times: FloatArray, angles: FloatArray) -> RecordedJoints:
        """The motion through angles [rad] (n, 3) at increasing times [s] (n,)."""
        from scipy.interpolate import PchipInterpolator  # slow to import

        return RecordedJoints(times, PchipInterpolator(times, angles, axis=0))

    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]."""
        return np.asarray(self.curve(min(max(time, self.times[0]), self.times[-1])))


def quintic(s: float) -> float:
    """Smooth step 10 s^3 - 15 s^4 + 6 s^5 from 0 to 1, clipped outside."""
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
