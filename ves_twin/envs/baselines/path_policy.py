"""PathPolicy: brings the arm to its goal along a planned path, set-points by time alone."""

from __future__ import annotations

import abc

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec
from ves_twin.mechanics.joint_motion import quintic
from ves_twin.mechanics.path_motion import at_lengths, path_lengths

DURATION = 5.0
"""Time of a move [s]. Source: coupling_map_paths; 4 s and less defeat the coupling map."""

PULL = 1.0
"""Rate at which set-points return to the plan [1/s]; a share of -1 to 1 rounds nothing off."""


class PathPolicy(Policy, abc.ABC):
    """Plans when an episode begins, then follows the plan's rates."""

    def __init__(self, briefing: TaskSpec) -> None:
        if "goal" not in briefing.observations.slices or briefing.emulated is None:
            raise InvalidInputError(type(self).__name__, "no goal", "VesTwin/VibrationFreeReach-v0")
        self._briefing = briefing
        self._scale = briefing.actions.high
        self._plan = np.zeros((2, 3))

    @abc.abstractmethod
    def plan(self, start: FloatArray, goal: FloatArray) -> FloatArray:
        """Joint angles at the beginning of each step, from now to the end [rad] (n, 3)."""

    def begin(self, observation: FloatArray) -> None:
        """Plan from the present set-points to the goal."""
        seen = self._briefing.observations.split(observation)
        self._at = seen["arm.command"].copy()
        self._plan = self.plan(self._at, seen["goal"])
        self._rate, self._step = np.zeros(3), 0

    def act(self, observation: FloatArray) -> FloatArray:
        """The rate that reaches the plan at the end of the step, as the set-points will go."""
        h = self._briefing.step
        ahead = np.clip(np.arange(self._step + 1, self._step + 3), 0, len(self._plan) - 1)
        self._step += 1
        wanted = (self._plan[ahead[1]] - self._plan[ahead[0] - 1]) / (2.0 * h)
        after = self._at + 0.5 * h * (self._rate + wanted)
        wanted = np.clip(wanted + PULL * (self._plan[ahead[0]] - after), -self._scale, self._scale)
        self._at = self._at + 0.5 * h * (self._rate + wanted)
        self._rate = wanted
        return np.asarray(wanted / self._scale)


def timed(path: FloatArray, duration: float, step: float, whole: float) -> FloatArray:
    """A path (k, 3) as places at every step: a quintic in its length, then rest at its end.

    Args:
        path: joint angles along the way [rad] (k, 3).
        duration: of the move [s].
        step: between places [s].
        whole: time to fill [s].
    """
    lengths = path_lengths(path)
    count = int(np.ceil(whole / step)) + 2
    shares = np.array([quintic(k * step / duration) for k in range(count)])
    return at_lengths(path, lengths, shares * lengths[-1])
