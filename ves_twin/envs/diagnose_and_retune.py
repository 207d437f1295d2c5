"""DiagnoseAndRetune: experiments on a machine with a sealed fault, then a score of its control."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray
from ves_twin.envs.joint_task import SECONDS, JointTask, Trial
from ves_twin.envs.policy import TrialSpec
from ves_twin.envs.task_env import Observation, TaskEnv
from ves_twin.machines.load import machine_of
from ves_twin.machines.machine import Machine
from ves_twin.suites.mjcf import BlindMjcf

MACHINE = "pendulum"
"""A diagnosis takes seconds here, and minutes on VES II."""

FAINTEST = 0.1
"""Of the largest plausible size, the least that is hidden; sizes are even on a logarithm."""

MOST = 100
"""Experiments of an episode; more than anybody waits for."""

OPTIONS = ("hidden",)
"""What `reset` understands."""


@final
class DiagnoseAndRetune(TaskEnv):
    """Return: minus the rms error [mrad] with which the last trial follows its motion.

    A step is a trial: the machine follows a motion of 4 s under the controller that the action
    asks for, with a test effort on top, and the observation is what was recorded. All trials but
    the last are experiments and free; the last has no test effort and is scored by the true
    position. An action of zeros is the controller of the believed machine.

    An episode draws one cause of the machine's library at a tenth to all of its largest size, and
    the numbers of the machine within their tolerances. Start and zero of the amplifier are drawn
    for each trial.

    Args:
        plant: an MJCF machine of one driven joint; the pendulum if left out.
        experiments: trials before the one that is scored.
        render_mode: None; a recording is not seen while it is made.
        scaled: as in `TaskEnv`.

    Raises:
        VesTwinError: a machine that cannot be used.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  (as the base class has it)

    def __init__(
        self,
        plant: str | Machine | None = None,
        experiments: int = 3,
        render_mode: str | None = None,
        scaled: bool = False,
    ) -> None:
        if render_mode is not None:
            raise InvalidInputError("render_mode", render_mode, "None")
        if not 0 <= experiments <= MOST:
            raise InvalidInputError("experiments", experiments, f"0 to {MOST}")
        self.render_mode = None
        self._trials = experiments + 1
        self._task = JointTask.of(machine_of(plant or MACHINE))
        self._blind = BlindMjcf(self._task.rig)
        super().__init__(*self._task.tables(self._trials), scaled)
        self._left = 0

    def briefing(self) -> TrialSpec:
        """Tables, the believed machine with its task, how many trials."""
        return TrialSpec(self.observations, self.actions, self._task, self._trials)

    @property
    def faults(self) -> list[dict[str, Any]]:
        """The sealed one."""
        labels = {name: h for h in self._blind.forward.hypotheses for name in h.parameters}
        return [
            {"kind": labels[name].effect, "target": labels[name].target, "value": value}
            for name, value in self._hidden.items()
        ]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Seal a fault; nothing is recorded yet.

        Args:
            seed: of everything drawn from here on.
            options: `hidden`: values of parameters by name, in place of a drawn fault.

        Raises:
            UnknownNameError: an unknown option or parameter.
        """
        super().reset(seed=seed)
        given = options or {}
        for key in given:
            if key not in OPTIONS:
                raise UnknownNameError("option of reset", str(key), OPTIONS)
        parameters = {p.name: p for p in self._blind.forward.parameters}
        drawn = self._drawn()
        self._hidden = dict(given.get("hidden", drawn))
        for name in self._hidden:
            if name not in parameters:
                raise UnknownNameError("parameter", name, parameters)
        tolerances = self._blind.commissioned(self.np_random)
        # no computer reads what is yet to come
        late = {n: max(v, 0.0) for n, v in tolerances.items() if n.endswith("delay")}
        self._values = {**tolerances, **late, **self._hidden}
        self._left = self._trials
        nothing = np.zeros((len(self._task.time), 3))
        return self._seen(nothing), self._info(0.0, clipped=False)

    def step(self, action: FloatArray) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Make a trial.

        Raises:
            InvalidInputError: another shape, not finite, or no episode under way.
        """
        if not self._left:
            raise InvalidInputError("step", "an episode that is over", "reset before it")
        wanted, clipped = self.physical(action)
        trial = self._trial(wanted)
        self._left -= 1
        over = not self._left
        info = self._info(trial.saturated, clipped)
        if over:
            peak = float(1e3 * np.max(np.abs(trial.error)))
            info["metrics"] = {
                "return": -trial.score, "tracking_rms": trial.score, "tracking_peak": peak
            }  # fmt: skip
        return self._seen(trial.rows), -trial.score if over else 0.0, False, over, info

    def _trial(self, wanted: FloatArray) -> Trial:
        values = self.actions.split(wanted)
        task = self._task
        test = task.test(float(values["test.effort"][0]), float(values["test.pitch"][0]))
        return task.run(
            task.tuning(values),
            self.np_random,
            test=test if self._left > 1 else None,
            values=self._blind.again(self._values, self.np_random, 1.0, 0.0),
            refined=True,
        )

    def _drawn(self) -> dict[str, float]:
        """Values of a cause's parameters, by `np_random` alone."""
        rng, forward = self.np_random, self._blind.forward
        nominal = {p.name: p for p in forward.parameters}
        cause = forward.hypotheses[int(rng.integers(len(forward.hypotheses)))]
        sign = float(rng.choice(cause.signs))
        found = {}
        for name, largest in zip(cause.parameters, cause.largest, strict=True):
            size = sign * largest * FAINTEST ** float(rng.uniform())
            one = nominal[name]
            low = max(one.low, 0.0) if name.endswith("delay") else one.low
            found[name] = float(np.clip(one.nominal + size, low, one.high))
        return found

    def _seen(self, rows: FloatArray) -> Observation:
        columns = dict(zip(self._task.signals, rows.T, strict=True))
        return self.observed({**columns, "trials.left": np.array([float(self._left)])})

    def _info(self, saturated: float, clipped: bool) -> dict[str, Any]:
        return {
            "time": (self._trials - self._left) * SECONDS,
            "cost": saturated,
            "costs": {"effort": saturated},
            "clipped": clipped,
            "outcome": "running" if self._left else "completed",
        }
