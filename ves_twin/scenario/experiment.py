"""Experiment: what a scenario says of a simulated run, said of a measured recording."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated, Any, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.refusal import refusal
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.plant.known_weight import hang_weight
from ves_twin.plant.plant import Plant
from ves_twin.scenario.experiment_file import ExperimentFile
from ves_twin.scenario.fields import Joints, Part, Pose, Seconds, named, si
from ves_twin.scenario.schema import Scenario

DRIVES = ("leg.command", "platform.command", "arm.command", "gravity.estimate")
"""What can be fed into a plant."""

COMPARED = (
    "leg.length",
    "valve.command",
    "sensor.wrench",
    "arm.q",
    "arm.torque",
    "supply.pressure",
)
"""What is compared if nothing is said."""

COMPARABLE = tuple(
    n for n, s in SIGNALS.items() if s.role is Role.MEASUREMENT or n == "valve.command"
)


class StartState(StrEnum):
    """How the rig is taken to begin.

    SETTLED: at rest at the first set-points. GIVEN: at rest at a pose and joint angles of the
    file. ESTIMATED: in motion; it is started at rest and its first `forget` seconds, in which
    loops and filters forget that, are not compared.
    """

    SETTLED = "settled"
    GIVEN = "given"
    ESTIMATED = "estimated"


class Start(Part):
    """Initial state of the rig."""

    state: Annotated[StartState, named("start state", [s.value for s in StartState])] = (
        StartState.SETTLED
    )
    pose: Pose | None = None
    joints: Joints | None = None
    forget: Annotated[Seconds, Field(ge=0, le=60)] = 2.0

    @model_validator(mode="after")
    def _given_is_given(self) -> Self:
        here = self.pose is not None and self.joints is not None
        if self.state is StartState.GIVEN and not here:
            raise ValueError("start: state 'given' needs start.pose and start.joints")
        if self.state is not StartState.GIVEN and (self.pose or self.joints):
            raise ValueError(f"start: pose and joints are for state 'given', not '{self.state}'")
        return self


class Window(Part):
    """Stretch that is compared; the set-points before it are fed in too."""

    start: Annotated[Seconds, Field(ge=0)] = 0.0
    stop: Annotated[Seconds, Field(gt=0)] = 1e9

    @model_validator(mode="after")
    def _stop_is_later(self) -> Self:
        if self.stop <= self.start:
            raise ValueError(f"window: stop {self.stop} s is not after start {self.start} s")
        return self


class Differences(Part):
    """What one recording has of its own: what is not said is as the experiment says."""

    parameters: dict[str, Any] = Field(default_factory=dict)
    payload: Annotated[float, si("kg"), Field(ge=0, le=50)] | None = None
    noise: str | None = None
    start: Start | None = None
    window: Window | None = None


class Experiment(ExperimentFile):
    """How a recording was made, as far as its own metadata do not say.

    `scenario` gives clocks, leg gains, belief and the emulated system; `settings` are dotted keys
    changed in it. `parameters` are numbers of the plant in these recordings only; `payload` is a
    known mass at the tool. `noise` is "auto" (a part that stands still if there is one, else
    declared), "declared", or a recording of the rig standing still. `recordings` holds by name
    what single recordings have of their own.
    """

    drive: tuple[Annotated[str, named("signal to feed in", DRIVES)], ...] = ()
    compare: tuple[Annotated[str, named("signal to compare", COMPARABLE)], ...] = ()
    plant: str | None = None
    scenario: str | None = None
    settings: dict[str, Any] = Field(default_factory=dict)
    parameters: dict[str, Any] = Field(default_factory=dict)
    payload: Annotated[float, si("kg"), Field(ge=0, le=50)] = 0.0
    noise: str = "auto"
    start: Start = Start()
    window: Window = Window()
    recordings: dict[str, Differences] = Field(default_factory=dict)

    @field_validator("drive")
    @classmethod
    def _legs_are_driven(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        if names and not {"leg.command", "platform.command"} & set(names):
            raise ValueError(f"drive: got {list(names)}, expected leg.command or platform.command")
        return names

    @model_validator(mode="after")
    def _settings_change_a_scenario(self) -> Self:
        if self.settings and self.scenario is None:
            raise ValueError("settings: they change a scenario, and none is named")
        return self

    def rig(self, given: Plant | None, scenario: Scenario) -> Plant:
        """The plant that is tried, with the numbers and the payload of the experiment.

        Args:
            given: by the caller; else the experiment's own, else the scenario's.
            scenario: that the recording is replayed by.
        """
        rig = given or Plant.load(self.plant or scenario.plant)
        rig = rig.with_values(self.parameters)
        return hang_weight(rig, self.payload) if self.payload else rig

    def scenario_of(self, recording: Recording) -> Scenario:
        """The scenario that a recording is replayed by, started as the experiment says.

        Raises:
            InvalidInputError: none is named and the recording has none.
        """
        if self.scenario is not None:
            scenario = Scenario.load(self.scenario, self.settings)
        else:
            scenario = _own_scenario(recording)
        if self.start.pose is None or self.start.joints is None:
            return scenario
        platform = scenario.platform.model_copy(update={"start": self.start.pose})
        still = {"start": self.start.joints, "moves": (), "path": None}
        arm = scenario.arm.model_copy(update=still)
        return scenario.model_copy(update={"platform": platform, "arm": arm})

    def drive_of(self, recording: Recording) -> tuple[str, ...]:
        """Signals that are fed in: those named, else those that the recording has.

        Raises:
            UnknownNameError: a signal that is named and not recorded, or no set-points of legs.
        """
        for name in self.drive:
            if name not in recording.signals:
                raise UnknownNameError("signal in the recording", name, recording.signals)
        if self.drive:
            return self.drive
        legs = "leg.command" if "leg.command" in recording.signals else "platform.command"
        if legs not in recording.signals:
            raise UnknownNameError("signal in the recording", "leg.command", recording.signals)
        return (legs, *(n for n in ("arm.command", "gravity.estimate") if n in recording.signals))


def _own_scenario(recording: Recording) -> Scenario:
    try:
        content = json.loads(recording.info.settings)
    except (ValueError, RecursionError):
        raise InvalidInputError(
            "settings of the recording", recording.info.settings, "a scenario as JSON"
        ) from None
    if not content:
        raise InvalidInputError(
            "recording", "no scenario in its metadata", "an --experiment file that names one"
        )
    try:
        return Scenario.model_validate(content)
    except ValidationError as error:
        raise refusal(error, "metadata of the recording", Scenario) from None
