"""RigDescription: the one TOML file that makes an MJCF model a rig with recordings."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.resources import find_resource, resource_folder
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.units import SI_UNITS
from ves_twin.diagnosis.grid import RATE
from ves_twin.effects.element import Element
from ves_twin.scenario.fields import Hertz, Part, Seconds, named
from ves_twin.scenario.load import refusal

KIND = "rig"
"""What the file calls itself; a plant of VES II says nothing."""

SCHEMA = 1

Unit = Annotated[str, named("unit", sorted(SI_UNITS))]
Number = float | str
"""A number in SI, or a text with a unit; the place that reads it knows which."""


class Mode(StrEnum):
    """What is fed in.

    MOTION: joint positions as recorded; efforts and sensors are computed by inverse dynamics.
    CONTROL: actuator efforts as recorded, open loop. REFERENCE: set-points of the controllers of
    the file, closed loop.
    """

    MOTION = "motion"
    CONTROL = "control"
    REFERENCE = "reference"


class Column(Part):
    """A signal: columns of the file, and what makes them SI.

    value = scale * column + offset, then, for vectors given in the world, turned into the frame
    of a signal that holds a quaternion x, y, z, w (sensor to world).
    """

    columns: tuple[str, ...] = Field(min_length=1)
    unit: Unit
    scale: float = 1.0
    offset: float = 0.0
    noise: Number | tuple[Number, ...] = 0.0
    into: str = ""
    source: str = ""


class Clock(Part):
    """The column of time, or of the order of poses at rest."""

    column: str
    scale: Annotated[float, Field(gt=0)] = 1.0
    poses: bool = False


class Drive(Part):
    """What is fed in: signal of each joint (motion) or actuator (control).

    A free joint takes a signal of seven columns: x, y, z, then the quaternion x, y, z, w.
    `smoothing` is the corner of the low-pass before positions are differentiated. `held` says that
    recorded efforts are commands that a computer held from row to row, not samples of a current:
    what was given over a row is then compared with what its middle needs.

    Joints that are `imposed` move as their signal in `joints` says while all others are integrated,
    in mode CONTROL or REFERENCE; what their actuators must give is then predicted. Joints that are
    `locked` stand where the model has them.
    """

    mode: Mode
    joints: dict[str, str] = Field(default_factory=dict)
    actuators: dict[str, str] = Field(default_factory=dict)
    smoothing: Annotated[Hertz, Field(gt=0)] = 30.0
    held: bool = False
    imposed: tuple[str, ...] = ()
    locked: tuple[str, ...] = ()

    @property
    def imposed_signals(self) -> dict[str, str]:
        """Signal of each imposed joint."""
        return {joint: self.joints[joint] for joint in self.imposed}

    @model_validator(mode="after")
    def _something_is_fed(self) -> Self:
        if self.mode is Mode.MOTION and not self.joints:
            raise ValueError("drive: mode 'motion' needs drive.joints")
        if self.mode is Mode.CONTROL and not (self.actuators or self.imposed):
            raise ValueError("drive: mode 'control' needs drive.actuators or drive.imposed")
        return self


class Compared(Part):
    """Where the model has what a signal measured: a joint, an actuator's effort, or a sensor."""

    joint: str = ""
    of: Literal["position", "speed"] = "position"
    actuator: str = ""
    sensor: str = ""
    sign: Literal[-1, 1] = 1

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if sum(map(bool, (self.joint, self.actuator, self.sensor))) != 1:
            raise ValueError("expected one of joint, actuator, sensor")
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
    """The whole file, see docs/bring-your-own-rig.md."""

    name: str
    model: str
    about: str = ""
    rate: Annotated[Hertz, Field(gt=0)] = RATE
    clock: Clock
    signals: dict[str, Column]
    drive: Drive
    compare: dict[str, Compared]
    controllers: dict[str, Controller] = Field(default_factory=dict)
    start: dict[str, Start] = Field(default_factory=dict)
    parameters: tuple[Setting, ...] = ()
    effects: tuple[Allowed, ...] = ()
    typical: Typical = Typical()
    drift: Drift | None = None
    excitation: MultisineRange = MultisineRange()
    present: dict[str, dict[str, dict[str, float]]] = Field(default_factory=dict)
    data: tuple[Data, ...] = ()
    causes: Annotated[int, Field(ge=1, le=6)] = 4
    block: Seconds = 0.0


def is_rig(name_or_path: str) -> bool:
    """Whether a --plant option means an MJCF machine rather than a plant of VES II."""
    path = Path(name_or_path)
    if not path.suffix and len(path.parts) == 1:
        return name_or_path in shipped_rigs()
    return path.is_file() and read_toml("plant", path)[0].get("kind") == KIND


def shipped_rigs() -> list[str]:
    """Names of the rigs that come with the twin."""
    return sorted(p.name for p in _machines().iterdir() if _shipped(p.name).is_file())


def load_description(name_or_path: str) -> tuple[RigDescription, Path]:
    """The description of a rig, and the folder that its model is found from.

    A file with `base` adds to another one: its tables `parameters` and `present` are put on top.

    Raises:
        FileAccessError: missing file.
        UnknownNameError: unknown name or key; says the nearest one.
        InvalidInputError: wrong type or unit; says the key.
        VersionError: another schema.
    """
    shipped = name_or_path in shipped_rigs()
    path = _shipped(name_or_path) if shipped else find_resource("rig", "models", name_or_path)
    content, folder = _content(path, 0)
    try:
        return RigDescription.model_validate(content), folder
    except ValidationError as error:
        raise refusal(error, path.name, RigDescription) from None


def _machines() -> Path:
    return resource_folder("models") / "machines"


def _shipped(name: str) -> Path:
    return _machines() / name / f"{name}.toml"


def _content(path: Path, depth: int) -> tuple[dict[str, Any], Path]:
    content, _ = read_toml("rig", path)
    check_schema(content, path, SCHEMA)
    if content.pop("kind", None) != KIND:
        raise InvalidInputError(f"{path}: kind", None, f'"{KIND}"')
    content.pop("schema")
    base = content.pop("base", None)
    if base is None:
        return content, path.parent
    if depth > 3 or not isinstance(base, str):
        raise InvalidInputError(f"{path}: base", base, "the file of a rig, four deep at most")
    below = _shipped(base) if base in shipped_rigs() else path.parent / base
    under, folder = _content(below, depth + 1)
    return _over(under, content), folder


def _over(under: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """The base with what is put on top of it."""
    merged = {**under, **{k: v for k, v in top.items() if k not in ("parameters", "present")}}
    new = list(top.get("parameters", []))
    places = {_place(s) for s in new}
    merged["parameters"] = [s for s in under.get("parameters", []) if _place(s) not in places] + new
    present = {kind: dict(targets) for kind, targets in under.get("present", {}).items()}
    for kind, targets in top.get("present", {}).items():
        present.setdefault(kind, {}).update(targets)
    merged["present"] = present
    return merged


def _place(setting: dict[str, Any]) -> tuple[object, ...]:
    return tuple(setting.get(key) for key in ("body", "joint", "actuator", "tendon", "attribute"))
