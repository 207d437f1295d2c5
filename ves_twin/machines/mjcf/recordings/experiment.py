"""MjcfExperiment: how recordings of an MJCF machine were made, validated from TOML."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, field_validator, model_validator

from ves_twin.machines.mjcf.rig.column import Number
from ves_twin.machines.mjcf.rig.description import Start
from ves_twin.scenario.experiment import StartState, Window
from ves_twin.scenario.experiment_file import ExperimentFile
from ves_twin.scenario.fields import Part, Seconds, named, si

OF_VES_II = ("scenario", "settings")
"""Keys of an experiment with VES II that a rig has nothing for."""


class Load(Part):
    """A known mass that was fixed to a body in these recordings, a point in the body's axes [m]."""

    body: str
    mass: Annotated[float, si("kg"), Field(gt=0)]
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


class MjcfStart(Part):
    """Initial state: as the rig's file has it, given here by joint, or estimated.

    SETTLED: what the rig's file says. GIVEN: `joints` in place of it. ESTIMATED: in motion; the
    first rows say where and how fast, as well as their noise lets them, the fit corrects that in
    each recording, and the first `forget` seconds are not compared.
    """

    state: Annotated[StartState, named("start state", [s.value for s in StartState])] = (
        StartState.SETTLED
    )
    joints: dict[str, Start] = Field(default_factory=dict)
    forget: Annotated[Seconds, Field(ge=0, le=60)] = 0.0

    @model_validator(mode="after")
    def _given_is_given(self) -> Self:
        if (self.state is StartState.GIVEN) != bool(self.joints):
            raise ValueError("start: [start.joints.NAME] goes with state = 'given', and needs it")
        return self


class MjcfDifferences(Part):
    """What one recording has of its own: what is not said is as the experiment says."""

    parameters: dict[str, Number] = Field(default_factory=dict)
    payload: Load | None = None
    noise: str | None = None
    start: MjcfStart | None = None
    window: Window | None = None


class MjcfExperiment(ExperimentFile):
    """How a recording was made, as far as the rig's file does not say.

    `drive` are the signals that were fed in, and so tells the mode; `compare` those that are
    compared; both are the rig's own choice if left out. `plant` is the rig, where no command says
    it. `parameters` are numbers of the model in these recordings, `"load.mass" = "2.1 kg"`.
    `noise` is "declared", as the rig's file has it, or a recording of the rig standing still.
    """

    plant: str | None = None
    drive: tuple[str, ...] = ()
    compare: tuple[str, ...] = ()
    parameters: dict[str, Number] = Field(default_factory=dict)
    payload: Load | None = None
    noise: str = "declared"
    start: MjcfStart = MjcfStart()
    window: Window = Window()
    recordings: dict[str, MjcfDifferences] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _of_a_rig(cls, content: Any) -> Any:
        for key in OF_VES_II:
            if isinstance(content, dict) and key in content:
                raise ValueError(f"{key}: belongs to an experiment with VES II; a rig has its file")
        return content

    @field_validator("payload", mode="before")
    @classmethod
    def _payload_sits_somewhere(cls, value: Any) -> Any:
        if value is not None and not isinstance(value, dict | Load):
            raise ValueError(f'got {value!r}, expected {{ body = "...", mass = "... kg" }}')
        return value
