"""Scenario: one experiment, frozen and validated; numbers in SI or as text with a unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from ves_twin.control.leg_loop import EDGE, FilterPlace
from ves_twin.control.operation.state import State
from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
from ves_twin.core.refusal import refusal
from ves_twin.scenario.fields import (
    ZERO_JOINTS,
    ZERO_POSE,
    Hertz,
    Joints,
    Part,
    PerSecond,
    Pose,
    Seconds,
    named,
    si,
)
from ves_twin.scenario.load import scenario_content
from ves_twin.scenario.motions import Motion
from ves_twin.scenario.operation_part import Operation

LOG_CLOCKS = ("admittance", "leg", "tick")

EMULATING = ("admittance", "micro_gravity")
"""Modes that come with the twin and emulate a system."""


class Run(Part):
    """How long and how finely.

    `settle` is the time before t = 0 in which the rig stands under control with everything
    switched on, so that the start transient tells nothing.
    """

    duration: Annotated[Seconds, Field(gt=0, le=1e7)]
    settle: Annotated[Seconds, Field(gt=0, le=1e4)] = 2.0
    log: Annotated[Literal["admittance", "leg", "tick"], named("log clock", LOG_CLOCKS)] = (
        "admittance"
    )
    substeps: Annotated[int, Field(ge=1, le=64)] = 1
    noise: bool = True
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0


class Busy(Part):
    """From `start` on, for `duration`, each admittance cycle computes `extra` longer."""

    start: Annotated[Seconds, Field(ge=0)]
    duration: Annotated[Seconds, Field(gt=0)]
    extra: Annotated[Seconds, Field(ge=0)]


class Platform(Part):
    """Operating mode and admittance clock; `start` is where the platform is released.

    `busy` are times at which the computer of the admittance cycle needs longer than usual.
    """

    mode: Annotated[str, named("mode", PLATFORM_CONTROLLERS)]
    rate: Annotated[Hertz, Field(ge=1, le=1000)] = 80.0
    home: Pose = ZERO_POSE
    start: Pose = ZERO_POSE
    emulated: str | None = None
    motion: Motion | None = Field(default=None, discriminator="kind")
    busy: tuple[Busy, ...] = ()

    @model_validator(mode="after")
    def _mode_has_what_it_needs(self) -> Self:
        emulates = self.mode in EMULATING  # a mode of an installed package may take both or none
        if emulates and self.emulated is None:
            raise ValueError(f"mode '{self.mode}' needs platform.emulated, the system to emulate")
        if self.mode == "position" and self.emulated is not None:
            raise ValueError("mode 'position' emulates nothing; leave platform.emulated out")
        if emulates and self.motion is not None:
            raise ValueError(f"platform.motion is for mode 'position', not '{self.mode}'")
        return self


class Gravity(Part):
    """Gravity compensation; `age` is how many cycles old the estimate is when it is used.

    The estimate comes from another computer through shared memory, one cycle late (thesis 2.4.2).
    That is also nearly the delay of the force sensor's 20 Hz low-pass, so a fresher estimate is
    a worse one: it runs ahead of the reading that it is taken off. Method `model` predicts from
    the masses of the belief, or from the calibration in `file`, whose matrix C the sensor then has.
    Method `learned` plays the wrench that the Learning Method left in `file`.

    `error` makes the estimate wrong on purpose, by a share of itself: from `error_since` on, or, if
    that is left out, always, so that zeroing hides what it does at the start pose.
    """

    method: Annotated[str, named("gravity method", GRAVITY_COMPENSATIONS)] = "none"
    age: Annotated[int, Field(ge=0, le=50)] = 1
    zero: bool = True
    file: str | None = None
    error: Annotated[float, Field(ge=-1, le=1)] = 0.0
    error_since: Annotated[Seconds, Field(ge=0)] | None = None

    @model_validator(mode="after")
    def _file_is_for_its_method(self) -> Self:
        if self.file is not None and self.method not in ("model", "learned"):
            raise ValueError(f"gravity.file is for 'model' or 'learned', not '{self.method}'")
        if self.file is None and self.method == "learned":
            raise ValueError("method 'learned' needs gravity.file, written by the Learning Method")
        return self


class Legs(Part):
    """Leg loop: gain K1 and rate gain K2 in physical units, what the section filters, its edge."""

    gain: Annotated[PerSecond, Field(ge=0)] = 12.6
    rate_gain: Annotated[float, si("1"), Field(ge=0)] = 0.0
    filter: Annotated[FilterPlace, named("filter place", [p.value for p in FilterPlace])] = (
        FilterPlace.NONE
    )
    edge: Annotated[Hertz, Field(gt=0)] = EDGE


class JointMove(Part):
    """One quintic joint move."""

    start: Annotated[Seconds, Field(ge=0)]
    duration: Annotated[Seconds, Field(gt=0)]
    to: Joints


class JointPath(Part):
    """A way from the arm's start through places, one quintic in its length, no stop between."""

    start: Annotated[Seconds, Field(ge=0)]
    duration: Annotated[Seconds, Field(gt=0)]
    through: Annotated[tuple[Joints, ...], Field(min_length=1)]


class Arm(Part):
    """Joint angles at the start, and the moves or the path after it, or what an operator does.

    `operator` is a file of joint commands over time (t, q1, q2, q3 in s and rad), a name of
    scenarios/data/ or a path. Nothing that plays the rig may look ahead in it.
    `gravity_feedforward` adds the torque that the believed weight needs to the joint servo, once
    a cycle; a soft servo without integrator would sag.
    """

    start: Joints = ZERO_JOINTS
    moves: tuple[JointMove, ...] = ()
    operator: str | None = None
    path: JointPath | None = None
    gravity_feedforward: bool = False

    @model_validator(mode="after")
    def _path_or_moves(self) -> Self:
        given = [self.path is not None, bool(self.moves), self.operator is not None]
        if self.path is not None and sum(given) > 1:
            raise ValueError("arm: give one of arm.moves, arm.path and arm.operator")
        if self.path is not None and all(place == self.start for place in self.path.through):
            raise ValueError("arm.path never leaves arm.start")
        return self

    @model_validator(mode="after")
    def _moves_follow_each_other(self) -> Self:
        if self.operator is not None and self.moves:
            raise ValueError("arm.moves are planned; with arm.operator leave them out")
        for one, two in zip(self.moves, self.moves[1:], strict=False):
            if two.start < one.start + one.duration - 1e-9:  # round-off of a sum of times
                raise ValueError(
                    f"arm.moves: the move at {two.start} s starts before the one at"
                    f" {one.start} s has ended"
                )
        return self


class Scenario(Part):
    """One experiment: world, belief, controllers, what is asked, and the question it answers.

    `plant`, `parameters` and `effects` are the world; `belief` is what the controllers take it
    to be. Their difference is what the emulation gets wrong.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{1,64}$")]
    question: Annotated[str, Field(min_length=1)]
    plant: str = "ves2"
    belief: str = "ves2"
    parameters: dict[str, Any] = Field(default_factory=dict)
    effects: dict[str, Any] = Field(default_factory=dict)
    run: Run
    platform: Platform
    gravity: Gravity = Gravity()
    legs: Legs = Legs()
    arm: Arm = Arm()
    operation: Operation | None = None

    @model_validator(mode="after")
    def _what_is_learned_is_planned(self) -> Self:
        if self.gravity.method == "learned" and self.arm.operator is not None:
            raise ValueError(
                "gravity.method 'learned' needs commands that are known in advance, and"
                " arm.operator gives none; use 'model'"
            )
        return self

    @property
    def has_reference(self) -> bool:
        """Whether a zero-g reference exists to compare with."""
        runs = self.operation is None or self.operation.begin is State.RUN
        return runs and self.platform.emulated is not None and self.platform.mode != "admittance"

    @staticmethod
    def load(name_or_path: str, changes: Mapping[str, object] | None = None) -> Scenario:
        """A scenario by name or from a file, with some keys changed.

        Args:
            name_or_path: "beam_horizontal_truth", or a path to a TOML file.
            changes: dotted keys to values, for instance {"legs.gain": 16.0}.

        Raises:
            FileAccessError: missing or unreadable file.
            UnknownNameError: unknown scenario or key; says the nearest one.
            InvalidInputError: wrong type, unit, shape or range; says the key.
        """
        content, where = scenario_content(name_or_path, changes or {})
        try:
            return Scenario.model_validate(content)
        except ValidationError as error:
            raise refusal(error, where, Scenario) from None
