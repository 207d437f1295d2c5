"""RigEnv: the simulator as a Gymnasium environment; a task says what is commanded and rewarded."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Generic

import gymnasium as gym
import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import Block, FloatArray
from ves_twin.envs.channels import Channels
from ves_twin.envs.costs import Costs, Limits
from ves_twin.envs.given import given_plant, given_scenario
from ves_twin.envs.picture import Picture
from ves_twin.envs.policy import TaskSpec
from ves_twin.envs.rig_set import RigSet
from ves_twin.envs.settled_rigs import Hand, SettledRig, SettledRigs
from ves_twin.envs.task_env import Observation, TaskEnv
from ves_twin.envs.true_state import true_state
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.cycles import SAMPLE
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.recorder import Sink
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.simulator import Simulator

if TYPE_CHECKING:
    from control import StateSpace

CYCLES = 4
"""Admittance cycles of a step: about 50 ms, a twelfth of the period of the fastest beam mode that
matters (1.3 Hz), and short beside what a cycle takes in Python."""

OPTIONS = ("goal", "plant", "scenario")
"""What `reset` understands."""


class RigEnv(TaskEnv, Generic[Hand]):
    """One rig under one task; a step is CYCLES admittance cycles.

    Observations are what the computers of the laboratory read.

    Attributes:
        sink: where the rows of the next episodes go; None for nowhere.

    Args:
        plant: the world; the scenario's own if left out.
        scenario: the task's own if left out.
        render_mode: "rgb_array", "human" or None.
        scaled: observations as shares of their bounds, in single precision; see `TaskEnv`.

    Raises:
        VesTwinError: a plant or scenario that cannot be used.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012  (as the base class has it)
        "render_modes": ["human", "rgb_array"],
        "render_fps": 20,
    }
    SCENARIO: ClassVar[str]
    WORST: ClassVar[float]
    """Loss per second [loss/s] that what is left of an episode counts as after a safety stop."""
    HIDDEN: ClassVar[str] = ""
    """Set of rigs that an episode's is drawn from; none if empty."""

    _costs: Costs
    _samples: Block

    def __init__(
        self,
        plant: str | Plant | None = None,
        scenario: str | Scenario | None = None,
        render_mode: str | None = None,
        scaled: bool = False,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise UnknownNameError("render_mode", str(render_mode), self.metadata["render_modes"])
        self.render_mode = render_mode
        self._scenario = given_scenario(scenario or self.SCENARIO)
        self._plant = given_plant(plant or self._scenario.plant)
        self.check(self._scenario)
        super().__init__(*self.channels(self._scenario), scaled)
        self.sink: Sink | None = None
        self._rigs: SettledRigs[Hand] = SettledRigs()
        self._rig: SettledRig[Hand] | None = None
        self._over = True
        self._picture = Picture(render_mode == "human")

    @abc.abstractmethod
    def check(self, scenario: Scenario) -> None:
        """Raise InvalidInputError unless a scenario fits the task."""

    @abc.abstractmethod
    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """Tables of observations and actions; they must not depend on what episodes draw."""

    @abc.abstractmethod
    def build(self, plant: Plant, scenario: Scenario) -> tuple[Simulator, Hand]:
        """A simulator, and what an action commands in it."""

    @abc.abstractmethod
    def start(self, goal: Any) -> None:
        """Begin an episode with a goal; the rig stands at t = 0."""

    @abc.abstractmethod
    def command(self, action: FloatArray, span: float) -> None:
        """Give an action, in the units of `actions`, for the step that begins now."""

    @abc.abstractmethod
    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Sum of the losses per second at the ends of a step's cycles.

        Args:
            poses: true poses [m, rad] (k, 6).
            arm_q: true joint angles [rad] (k, 3).
            times: when [s] (k,).
        """

    @abc.abstractmethod
    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """The observation's values by name; bounds are applied by the caller."""

    @abc.abstractmethod
    def truth(self) -> dict[str, FloatArray | float]:
        """What only an analysis may see, beside pose and joints."""

    @abc.abstractmethod
    def metrics(self) -> dict[str, float]:
        """Figures of the episode so far, in physical units."""

    def prior(self) -> StateSpace:
        """The linear model that the believed rig has: actions in, deviations of readings out.

        Raises:
            InvalidInputError: a task whose actions are no input of a linear model.
        """
        raise InvalidInputError(type(self).__name__, "no linear prior", "a task that moves the rig")

    def hidden(self, plant: Plant) -> Plant:
        """A plant with what the task hides in it, drawn by `np_random` alone.

        Called for plants without effects: whoever gives a rig with faults has hidden his own.
        """
        return RigSet.load(self.HIDDEN).draw(plant, self.np_random) if self.HIDDEN else plant

    def draw(self, scenario: Scenario, goal: object) -> tuple[Scenario, object]:
        """Scenario and goal of an episode, drawn where `goal` is None, by `np_random` alone.

        Raises:
            InvalidInputError: a goal that the task has none of.
        """
        if goal is not None:
            raise InvalidInputError("goal", goal, "none; scenario and rig say all of this task")
        return scenario, None

    def briefing(self) -> TaskSpec:
        """What a policy may know before it begins: tables, times, beliefs, the linear model."""
        emulated = self._scenario.platform.emulated
        return TaskSpec(
            observations=self.observations,
            actions=self.actions,
            step=self.span,
            duration=self._scenario.run.duration,
            belief=Plant.load(self._scenario.belief),
            scenario=self._scenario,
            emulated=None if emulated is None else EmulatedSystem.load(emulated),
            prior=self.prior,
        )

    @property
    def faults(self) -> list[dict[str, Any]]:
        """Effects of the plant."""
        return [{"kind": e.kind, "target": e.target, **e.values} for e in self.sim.plant.effects]

    @cached_property
    def span(self) -> float:
        """Length of a step [s]."""
        tick = self._plant.parameters.number("clock.tick")
        return CYCLES * tick * max(1, round(1.0 / (self._scenario.platform.rate * tick)))

    @property
    def sim(self) -> Simulator:
        """The simulator of the present episode, for analysis.

        Raises:
            InvalidInputError: before the first reset.
        """
        if self._rig is None:
            raise _before_reset()
        return self._rig.sim

    @property
    def hand(self) -> Hand:
        """What actions command in the present episode."""
        if self._rig is None:
            raise _before_reset()
        return self._rig.hand

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode; nothing of the ones before it is left.

        Args:
            seed: of everything drawn from here on: goals, and the noise of this and later episodes.
            options: `plant` (name, file or Plant), `scenario` (name, file or Scenario) and `goal`
                for this episode alone.

        Raises:
            VesTwinError: an unknown option, or a rig that cannot be built or cannot stand.
        """
        super().reset(seed=seed)
        given = options or {}
        for key in given:
            if key not in OPTIONS:
                raise UnknownNameError("option of reset", str(key), OPTIONS)
        noise_seed = int(self.np_random.integers(2**63 - 1))
        scenario = given_scenario(given.get("scenario", self._scenario))
        if "scenario" in given:
            self.check(scenario)
        plant = self.plant_of(given)
        plant = plant if plant.effects else self.hidden(plant)
        scenario, goal = self.draw(scenario, given.get("goal"))
        self._rig = self._rigs.find(plant, scenario) or self._rigs.keep(
            plant, *self.build(plant, scenario)
        )
        self._rig.begin(noise_seed, self.sink)
        self._begin_accounts()
        self.start(goal)
        self._board_pose = np.array(scenario.platform.start)
        if self.render_mode == "human":
            self.render()
        return self._observe(), self._info(clipped=False)

    def step(self, action: FloatArray) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Hold an action for a step.

        Args:
            action: shares of the scale of `actions` (n,).

        Raises:
            InvalidInputError: another shape, not finite, or no episode under way.
        """
        if self._over or self._rig is None:
            raise InvalidInputError("step", "an episode that is over", "reset before it")
        wanted, clipped = self.physical(action)
        sim = self._rig.sim
        self.command(wanted, self._cycle * CYCLES)
        lost = self._run_cycles(sim) * self._cycle
        self._steps += 1
        terminated = sim.outcome is not None
        if terminated:
            lost += self.WORST * max(sim.scenario.run.duration - sim.time, 0.0)
        truncated = not terminated and self._steps >= self._last
        self._over = terminated or truncated
        if truncated:
            sim.end(Outcome.COMPLETED, f"reached {sim.time:.3f} s")
        self._return -= lost
        if self.render_mode == "human":
            self.render()
        info = self._info(clipped)
        if self._over:
            info["metrics"] = {"return": self._return, **self.metrics()}
        return self._observe(), -lost, terminated, truncated, info

    def _run_cycles(self, sim: Simulator) -> float:
        """Run the cycles of a step; gives their losses, and keeps the state of the last one."""
        rig = sim.rig
        ended = sim.run_to(rig.tick + CYCLES * rig.clock.admittance, self._samples)
        samples = self._samples[:ended]
        self._costs.update(samples)
        poses, arm_q = samples["pose"].copy(), samples["arm_q"].copy()
        self._state = poses[-1], arm_q[-1]
        return self.loss(poses, arm_q, samples["time"].tolist())

    def render(self) -> Any:
        """A picture (480, 640, 3), or the window, as the render mode asks.

        Raises:
            VesTwinError: no OpenGL, or no display for `human`.
        """
        if self.render_mode is None:
            gym.logger.warn("render() without a render_mode; make the environment with one")
            return None
        return self._picture.show(self.sim.model, self.sim.data)

    def plant_of(self, options: Mapping[str, object]) -> Plant:
        """The plant that `reset` would take by its options, without the scenario's own changes."""
        if "plant" in options:
            return given_plant(options["plant"])
        return (
            given_plant(given_scenario(options["scenario"]).plant)
            if "scenario" in options
            else self._plant
        )

    def close(self) -> None:
        """Close window and renderer; allowed more than once."""
        self._picture.close()

    def _begin_accounts(self) -> None:
        sim = self.sim
        belief = Plant.load(sim.scenario.belief)
        number = belief.parameters.number
        self._cycle = sim.rig.clock.admittance * sim.rig.clock.tick
        self._last = max(1, round(sim.scenario.run.duration / (CYCLES * self._cycle)))
        self._steps, self._return, self._over = 0, 0.0, False
        limits = Limits(
            home_lengths=belief.geometry.lengths(np.zeros(6)),
            travel=number("leg.stroke") / 2.0 - number("leg.margin"),
            wrench=belief.parameters.array("sensor.range"),
        )
        self._state = true_state(sim.rig)
        self._samples = np.zeros(CYCLES, SAMPLE)
        self._geometry = belief.geometry
        self._costs = Costs(limits, self._cycle)
        self._costs.begin(sim.rig.board["sensor.wrench"][:3])

    @property
    def left(self) -> float:
        """Time until the episode is truncated [s]."""
        return (self._last - self._steps) * CYCLES * self._cycle

    @property
    def measured_pose(self) -> FloatArray:
        """Platform pose that the believed geometry has at the measured leg lengths (6,)."""
        return self._board_pose

    def _observe(self) -> Observation:
        sim = self.sim
        board = sim.rig.board
        if sim.outcome is not Outcome.DIVERGED:
            self._board_pose = self._geometry.pose(board["leg.length"], self._board_pose)
        return self.observed(self.readings(board))

    def _info(self, clipped: bool) -> dict[str, Any]:
        sim = self.sim
        costs = self._costs.costs()
        pose, arm_q = self._state
        info: dict[str, Any] = {
            "time": sim.time,
            "cost": sum(costs.values()),
            "costs": costs,
            "clipped": clipped,
            "outcome": "running" if sim.outcome is None else sim.outcome.value,
            "truth": {"truth.pose": pose, "truth.arm_q": arm_q, **self.truth()},
        }
        if sim.outcome not in (None, Outcome.COMPLETED):
            info["reason"] = f"{sim.events[-1].message}; {sim.outcome.advice}"
        return info


def _before_reset() -> InvalidInputError:
    return InvalidInputError("environment", "no episode", "reset before anything else")


def rig_env(env: gym.Env[Any, Any]) -> RigEnv[Any]:
    """The environment with a rig of VES II under any wrappers.

    Raises:
        InvalidInputError: an environment of another kind.
    """
    inner = env.unwrapped
    if not isinstance(inner, RigEnv):
        expected = "one of ves_twin.envs with a rig of VES II"
        raise InvalidInputError("environment", type(inner).__name__, expected)
    return inner
