"""Retuning: experiments, a twin of the machine from them, and the controller tuned on the twin."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import least_squares

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TrialSpec
from ves_twin.machines.mjcf.rig.machine import Rig

EFFORT = 0.8
"""Test effort of an experiment, as a share of its bound."""

PITCHES = (0.0, -0.5, 0.5)
"""Of the experiments in turn, as shares of an octave; further ones begin again."""

SOFTER = (0.0, -1.0 / 3.0, -2.0 / 3.0)
"""Feedbacks that are tried, in shares of three octaves, and the best on the twin is kept: with a
delay the nominal one may swing up. No finer: a twin flatters soft gains, since all that a machine
has beyond it is left to the feedback."""

FEEDBACK, TEST = 3, 2
"""Columns of the feedback, which come first, and of the test, which come last."""

ROUNDS = 8
"""Of the search; beyond it scores change by less than noise."""

STEP = 0.02
"""Of shares, for derivatives."""

EVERY = 10
"""Rows of a trial that are looked at: 50 Hz, ten times the fastest tone."""


class Retuning(Policy, abc.ABC):
    """The nominal controller with test efforts, then the one that is best on a twin."""

    def __init__(self, briefing: TrialSpec) -> None:
        if not isinstance(briefing, TrialSpec):
            what = "VesTwin/DiagnoseAndRetune-v0"
            raise InvalidInputError(type(self).__name__, "no trials", what)
        self.known = briefing

    @abc.abstractmethod
    def twin(self, records: Sequence[Recording]) -> tuple[Rig, Mapping[str, float]]:
        """The machine that the recordings show, and values of its parameters."""

    def begin(self, observation: FloatArray) -> None:
        """No trial yet."""
        self._records: list[Recording] = []

    def act(self, observation: FloatArray) -> FloatArray:
        """An experiment, or the controller at last."""
        seen, task = self.known.observations.split(observation), self.known.task
        left = round(float(seen["trials.left"][0]))
        made = self.known.trials - left
        if made:
            rows = np.stack([seen[name] for name in task.signals], axis=1)
            self._records.append(task.recording(rows, f"trial {made}"))
        if left > 1:
            action = np.zeros(self.known.actions.width)
            action[self.known.actions.slices["test.effort"]] = EFFORT
            action[self.known.actions.slices["test.pitch"]] = PITCHES[made % len(PITCHES)]
            return action
        return tuned(self.known, *self.twin(self._records))


def tuned(known: TrialSpec, rig: Rig, values: Mapping[str, float]) -> FloatArray:
    """The action, shares (n,), whose controller follows best on a machine.

    Least squares of the simulated errors, with the same noise in every run.

    Args:
        known: task and tables.
        rig: the machine.
        values: of its parameters, where they differ from its nominal ones.
    """
    task, actions = known.task, known.actions

    def errors(action: FloatArray) -> FloatArray:
        tuning = task.tuning(actions.split(action * actions.high))
        trial = task.run(tuning, np.random.default_rng(0), rig=rig, values=values)
        return np.asarray(1e3 * trial.error[::EVERY])

    whole = np.zeros(actions.width)
    starts = [np.where(np.arange(len(whole)) < FEEDBACK, softer, whole) for softer in SOFTER]
    best = min(starts, key=lambda action: float(np.sum(errors(action) ** 2)))

    def action(shares: FloatArray) -> FloatArray:
        return np.concatenate([best[:FEEDBACK], shares, np.zeros(TEST)])

    found = least_squares(
        lambda shares: errors(action(shares)),
        best[FEEDBACK:-TEST],
        bounds=(-1.0, 1.0),
        x_scale=0.1,
        diff_step=STEP,
        max_nfev=ROUNDS,
    )
    return action(found.x)
