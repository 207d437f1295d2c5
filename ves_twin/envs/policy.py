"""Policy: what an evaluation runs: observations in, actions out, and the briefing before it."""

from __future__ import annotations

import abc
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ves_twin.core.types import FloatArray
from ves_twin.envs.channels import Channels
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario

if TYPE_CHECKING:
    from control import StateSpace

    from ves_twin.envs.joint_task import JointTask


@dataclass(frozen=True)
class TaskSpec:
    """What a policy may know of an environment; nothing in it tells the truth about a plant.

    Attributes:
        observations: columns of the observation with units and bounds.
        actions: columns of the action; bounds are the scale of a share of 1.
        step: length of a step [s].
        duration: length of an episode [s].
        belief: the rig as the computers take it to be.
        scenario: the experiment.
        emulated: the base that the platform emulates, if any.
        prior: builds the linear model of the believed rig.
    """

    observations: Channels
    actions: Channels
    step: float
    duration: float
    belief: Plant
    scenario: Scenario
    emulated: EmulatedSystem | None
    prior: Callable[[], StateSpace]


@dataclass(frozen=True)
class TrialSpec:
    """The same for `DiagnoseAndRetune`.

    Attributes:
        observations: columns of a trial's recording.
        actions: columns of the controller and of the test; zeros are the believed machine's own.
        task: the believed machine, its simulation under a controller, recordings of trials.
        trials: in an episode; the last is scored.
    """

    observations: Channels
    actions: Channels
    task: JointTask
    trials: int


class Policy(abc.ABC):
    """Decides an action from an observation; one object serves many episodes in turn."""

    @classmethod
    def build(cls, briefing: Any) -> Policy:
        """A policy for an environment, by its `briefing()`: a TaskSpec, or a TrialSpec.

        Raises:
            InvalidInputError: an environment that it does not fit.
        """
        return cls(briefing)  # type: ignore[call-arg]  # an __init__ of more: its own build

    @abc.abstractmethod
    def begin(self, observation: FloatArray) -> None:
        """Forget the episode before; the first observation of the new one."""

    @abc.abstractmethod
    def act(self, observation: FloatArray) -> FloatArray:
        """The action, shares from -1 to 1 (n,), for an observation (m,)."""
