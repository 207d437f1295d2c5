"""RigDescription: the one TOML file that makes an MJCF model a rig with recordings."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ves_twin.data.mapping.import_map import Window
from ves_twin.diagnosis.model.grid import RATE
from ves_twin.effects.element import Element
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.mjcf.rig.column import Column, Number
from ves_twin.scenario.fields import Hertz, Part, Seconds, si

KIND = "rig"
"""What the file calls itself; a plant of VES II says nothing."""

SCHEMA = 1

CORNER = 1.25
"""Corner of the positions' low-pass over the band: what is compared is not rounded off."""


class Mode(StrEnum):
    """What is fed in.

    MOTION: joint positions as recorded; efforts and sensors are computed by inverse dynamics.
    CONTROL: actuator efforts as recorded, open loop. REFERENCE: set-points of the controllers of
    the file, closed loop.
    """

    MOTION = "motion"
    CONTROL = "control"
    REFERENCE = "reference"


class Clock(Part):
    """The column of time (s = scale * column), or of the order of poses at rest; else a rate."""

    column: str = ""
    scale: Annotated[float, Field(gt=0)] = 1.0
    rate: Annotated[Hertz, Field(ge=0)] = 0.0
    poses: bool = False

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if bool(self.column) == bool(self.rate):
            raise ValueError("clock: expected either column or rate")
        return self


class Drive(Part):
    """What is fed in: signal of each joint (motion) or actuator (control).

    A free joint takes a signal of seven columns: x, y, z, then the quaternion x, y, z, w.
    `smoothing` is the corner of the low-pass before positions are differentiated. `held` says that
    recorded efforts are commands that a computer held from row to row, not samples of a current:
    what was given over a row is then compared with what its middle needs.

    Joints that are `imposed` move as their signal in `joints` says while all others are integrated,
    in mode CONTROL or REFERENCE; what their actuators must give is then predicted. Joints that are
    `locked` stand where the model has them.

    Of a model without actuators nothing need be fed in: it is let go, in mode CONTROL.

    In mode CONTROL simulation begins `lead` after the first row: rows before it tell commands that
    a delay, or a filter, still lets through then. A measured start is read there.

    A diagnosis simulates pieces of `horizon`, each from its measured start; 0: whole recordings.
    """

    mode: Mode
    joints: dict[str, str] = Field(default_factory=dict)
    actuators: dict[str, str] = Field(default_factory=dict)
    smoothing: Annotated[Hertz, Field(gt=0)] = 30.0
    held: bool = False
    imposed: tuple[str, ...] = ()
    locked: tuple[str, ...] = ()
    lead: Annotated[Seconds, Field(ge=0)] = 0.0
    horizon: Annotated[Seconds, Field(ge=0)] = 0.0

    @property
    def imposed_signals(self) -> dict[str, str]:
        """Signal of each imposed joint."""
        return {joint: self.joints[joint] for joint in self.imposed}

    @model_validator(mode="after")
    def _something_is_fed(self) -> Self:
        if self.mode is Mode.MOTION and not self.joints:
            raise ValueError("drive: mode 'motion' needs drive.joints")
        if self.mode is not Mode.CONTROL and self.lead:
            raise ValueError(f"drive.lead: {self.lead:g} s in mode {self.mode}; mode 'control'")
        if self.mode is Mode.MOTION and self.horizon:
            raise ValueError(f"drive.horizon: {self.horizon:g} s in mode motion; what is simulated")
        return self


class Compared(Part):
    """Where the model has what a signal measured: a joint, an actuator's effort, or a sensor."""

    joint: str = ""
    of: Literal["position", "speed"] = "position"
    actuator: str = ""
    sensor: str = ""
    axis: Literal["", "x", "y", "z"] = ""
    sign: Literal[-1, 1] = 1

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if sum(map(bool, (self.joint, self.actuator, self.sensor))) != 1:
            raise ValueError("expected one of joint, actuator, sensor")
        if self.axis and not self.sensor:
            raise ValueError(f"axis {self.axis!r} without a sensor")
        return self


class Controller(Part):
    """PD on one actuator: u = kp (reference - q) - kd dq, within +-limit.

    dq is the backward difference of the mean of the last `average` samples of q, as sampled
    controllers have it; `average = 1` is the plain difference.
    """

    kind: Literal["pd"]
    joint: str
    reference: str
    kp: Annotated[float, Field(ge=0)]
    kd: Annotated[float, Field(ge=0)]
    limit: Annotated[float, Field(gt=0)] = 1e12
    average: Annotated[int, Field(ge=1, le=100)] = 1
    source: str = ""


class Elsewhere(Part):
    """Recordings whose first rows are not at the start: it is read off them.

    Beyond `position` or `speed` from the start a recording is taken to be cut out of a longer
    motion. Its first rows (`within`) tell the start to `sd` and `speed_sd`, and nothing else: what
    delays held back from before is in them.
    """

    position: Number
    speed: Number
    sd: Number
    speed_sd: Number
    within: Seconds


class Start(Part):
    """Where a joint begins in forward simulation.

    "measured" takes the first rows of its signal, "recorded" what the recording says itself, in
    the first row of a signal JOINT.start (position, speed). Rows before `settling` tell nothing.
    """

    position: Number = 0.0
    sd: Number = 0.0
    speed: Number = 0.0
    speed_sd: Number = 0.0
    settling: Seconds = 0.0
    elsewhere: Elsewhere | None = None

    @property
    def told(self) -> bool:
        """Whether a recording may say its own start."""
        return self.elsewhere is not None or self.position == "recorded"


class Setting(Part):
    """One attribute of an element of the model: nominal value, how well it is known, bounds."""

    attribute: str
    body: str = ""
    joint: str = ""
    actuator: str = ""
    tendon: str = ""
    value: Number | None = None
    sd: Number = 0.0
    low: Number | None = None
    high: Number | None = None
    source: str = ""

    @model_validator(mode="after")
    def _one_element(self) -> Self:
        if sum(map(bool, (self.body, self.joint, self.actuator, self.tendon))) != 1:
            raise ValueError("expected one of body, joint, actuator, tendon")
        return self

    @property
    def element(self) -> tuple[Element, str]:
        """What it belongs to."""
        if self.body:
            return Element.BODY, self.body
        if self.joint:
            return Element.JOINT, self.joint
        if self.tendon:
            return Element.TENDON, self.tendon
        return Element.ACTUATOR, self.actuator


class Allowed(Part):
    """A kind of effect that may be at work, where, and sizes other than the typical ones.

    "*" as the kind is every one that the model has a place for, in `on` every place of it; an
    entry of its own comes before that.
    `sd` makes it a commissioning error as well; 0 is "absent by declaration". `low` and `high`
    bound its size, where not by the largest one: a delay that is known to 0.2 ms may be below zero.
    """

    kind: str
    on: tuple[str, ...] = Field(min_length=1)
    sd: Number = 0.0
    smallest: Number | None = None
    largest: Number | None = None
    low: Number | None = None
    high: Number | None = None
    cause: bool = True
    per_recording: bool = False
    source: str = ""

    @model_validator(mode="after")
    def _of_one_recording(self) -> Allowed:
        if self.per_recording and (self.cause or not self.sd):
            raise ValueError(
                "expected cause = false and an sd beside per_recording: a cause is the same in all"
            )
        return self


class Span(Part):
    """Typical sizes at a joint or of a signal, from which sizes of effects follow."""

    effort: Number = 0.0
    speed: Number = 0.0
    travel: Number = 0.0
    span: Number = 0.0


class Typical(Part):
    """Typical sizes by joint and by signal."""

    joint: dict[str, Span] = Field(default_factory=dict)
    signal: dict[str, Span] = Field(default_factory=dict)


class Drift(Part):
    """Stretch of time that drift shapes span [s, or numbers of poses], and their count."""

    begin: float = 0.0
    end: float
    terms: Annotated[int, Field(ge=1, le=6)] = 4


class Data(Part):
    """A public recording of this rig that is not part of the project."""

    file: str
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    source: str


class MultisineRange(Part):
    """What multisines of this machine are made of; what is not said follows from typical sizes.

    `amplitude` is that of a tone, as a share of the typical effort or travel; tones lie in `band`.
    Rows are a `period` apart, or a step of the model.
    """

    amplitude: Annotated[float, Field(gt=0, le=1)] = 0.45
    band: tuple[Hertz, Hertz] | None = None
    duration: Annotated[Seconds, Field(gt=0, le=600)] = 4.0
    period: Annotated[Seconds, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _band_is_one(self) -> Self:
        if self.band is not None and not 0.0 < self.band[0] < self.band[1]:
            raise ValueError(f"excitation.band: got {self.band}, expected 0 < lowest < highest")
        return self


class RigDescription(Part):
    """The whole file, see docs/machine-file.md.

    `rate` is that of the analysis. Where positions are fed in and efforts compared, it follows from
    `drive.smoothing` if the file says none: `smoothing` takes from the motion what it does not from
    the efforts, and what is left of these above it would bend frictions.

    `tolerances` says how well all values of an attribute are known that have no sd of their own, as
    a share of them: `mass = "5 %"`.
    """

    name: str
    model: str
    about: str = ""
    clock: Clock
    window: Window = Window()
    signals: dict[str, Column]
    drive: Drive
    compare: dict[str, Compared] = Field(default_factory=dict)
    rate: Annotated[Hertz, Field(gt=0, default_factory=lambda told: _analysis_rate(told))]
    controllers: dict[str, Controller] = Field(default_factory=dict)
    start: dict[str, Start] = Field(default_factory=dict)
    parameters: tuple[Setting, ...] = ()
    tolerances: dict[str, Annotated[float, si("dimensionless"), Field(gt=0, le=1)]] = Field(
        default_factory=dict
    )
    effects: tuple[Allowed, ...] = ()
    typical: Typical = Typical()
    drift: Drift | None = None
    excitation: MultisineRange = MultisineRange()
    present: dict[str, dict[str, dict[str, float]]] = Field(default_factory=dict)
    laws: tuple[LawTable, ...] = ()
    data: tuple[Data, ...] = ()
    causes: Annotated[int, Field(ge=1)] = 4
    block: Seconds = 0.0

    @model_validator(mode="before")
    @classmethod
    def _places_of_signals(cls, content: object) -> object:
        """With `compare` and `drive` of the signals that say themselves where the model has them.

        A position is fed in where motion is, an actuator's where commands are.
        """
        if not isinstance(content, dict) or not isinstance(content.get("signals"), dict):
            return content
        compare, drive = content.get("compare", {}), content.get("drive", {})
        parts = [drive.get(key, {}) for key in ("joints", "actuators")] if _table(drive) else []
        if not (parts and all(map(_table, (compare, *parts)))):
            return content  # what is no table is refused by its field
        compare, drive, (joints, actuators) = dict(compare), dict(drive), map(dict, parts)
        for name, signal in content["signals"].items():
            if not isinstance(signal, dict):
                continue
            keys = ("joint", "of", "actuator", "sensor", "axis")
            place = {key: signal[key] for key in keys if key in signal}
            if not place:
                continue
            if name in compare:
                raise ValueError(f"compare.{name}: signals.{name} says it already")
            compare[name] = place
            if place.get("of", "position") == "position" and isinstance(place.get("joint"), str):
                joints.setdefault(place["joint"], name)
            if isinstance(place.get("actuator"), str):
                actuators.setdefault(place["actuator"], name)
        given = {"joints": joints, "actuators": actuators}
        drive |= {key: value for key, value in given.items() if value}
        return {**content, "compare": compare, "drive": drive}


def _analysis_rate(told: dict[str, Any]) -> float:
    """Of a file that says none, by the fields above it [Hz]."""
    drive, compare = told.get("drive"), told.get("compare", {})
    if drive is None:  # refused already
        return RATE
    fed = drive.mode is Mode.MOTION or drive.imposed
    efforts = any(place.actuator for place in compare.values())
    return min(RATE, 2.0 * drive.smoothing / CORNER) if fed and efforts else RATE


def _table(value: object) -> bool:
    return isinstance(value, dict)
