"""Signals: the table of every signal of the rig: name, unit, axes, frame, role."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from ves_twin.core.errors import InvalidInputError


class Role(StrEnum):
    """What a signal is to a controller or a diagnosis; `truth` is for analysis only."""

    REFERENCE = "reference"
    COMMAND = "command"
    MEASUREMENT = "measurement"
    TRUTH = "truth"


TIME = "t"
"""Column of the times in every file."""


@dataclass(frozen=True)
class Signal:
    """One named signal: `axes` give its columns, `units` the unit of each column.

    Raises:
        InvalidInputError: a column by the name of that of the times, `t`.
    """

    name: str
    axes: tuple[str, ...]
    units: tuple[str, ...]
    role: Role
    frame: str
    meaning: str

    def __post_init__(self) -> None:
        if TIME in self.columns:
            raise InvalidInputError("name of a signal", TIME, f"another one: {TIME} is the time")

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.axes)

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names in files: numbered from 1, a scalar without a number."""
        if self.width == 1:
            return (self.name,)
        return tuple(f"{self.name}.{i + 1}" for i in range(self.width))

    @property
    def field(self) -> str:
        """Name as an identifier, for structured arrays."""
        return self.name.replace(".", "_")


_POSE = ("x", "y", "z", "rx", "ry", "rz")
_POSE_UNITS = ("m", "m", "m", "rad", "rad", "rad")
_WRENCH = ("fx", "fy", "fz", "mx", "my", "mz")
_WRENCH_UNITS = ("N", "N", "N", "N*m", "N*m", "N*m")
_LEGS = tuple(f"leg {i}" for i in range(1, 7))
_JOINTS = ("q1", "q2", "q3")
_BENDING = tuple(f"leg {i} {axis}" for i in range(1, 7) for axis in ("x", "y"))
_HOME = "inertial, from platform home; fixed-axis X-Y-Z angles"


def _signal(
    name: str, axes: tuple[str, ...], unit: str | tuple[str, ...], role: Role, frame: str, what: str
) -> Signal:
    units = (unit,) * len(axes) if isinstance(unit, str) else unit
    return Signal(name, axes, units, role, frame, what)


_TABLE = (
    _signal("leg.command", _LEGS, "m", Role.COMMAND, "leg", "commanded pin-to-pin length"),
    _signal("leg.length", _LEGS, "m", Role.MEASUREMENT, "leg", "length by the transducer"),
    _signal("valve.command", _LEGS, "1", Role.COMMAND, "leg", "spool command, -1 to 1"),
    _signal("platform.command", _POSE, _POSE_UNITS, Role.COMMAND, _HOME, "commanded pose"),
    _signal("platform.pose", _POSE, _POSE_UNITS, Role.MEASUREMENT, _HOME, "pose from leg lengths"),
    _signal(
        "sensor.wrench",
        _WRENCH,
        _WRENCH_UNITS,
        Role.MEASUREMENT,
        "sensor",
        "wrench of the payload on the platform, filtered, calibrated, zeroed",
    ),
    _signal(
        "gravity.estimate",
        _WRENCH,
        _WRENCH_UNITS,
        Role.COMMAND,
        "sensor",
        "gravity wrench that is subtracted",
    ),
    _signal("arm.command", _JOINTS, "rad", Role.COMMAND, "joint", "set-point of the joint servo"),
    _signal("arm.q", _JOINTS, "rad", Role.MEASUREMENT, "joint", "joint angle by the encoder"),
    _signal("arm.torque", _JOINTS, "N*m", Role.MEASUREMENT, "joint", "torque of the drive"),
    _signal("supply.pressure", ("p",), "Pa", Role.MEASUREMENT, "manifold", "supply pressure"),
    _signal(
        "reference.pose", _POSE, _POSE_UNITS, Role.REFERENCE, _HOME, "pose of the zero-g reference"
    ),
    _signal(
        "reference.pose_leg_lag",
        _POSE,
        _POSE_UNITS,
        Role.REFERENCE,
        _HOME,
        "pose if the legs' bandwidth were the only imperfection",
    ),
    _signal("truth.pose", _POSE, _POSE_UNITS, Role.TRUTH, _HOME, "true platform pose"),
    _signal(
        "truth.wrench",
        _WRENCH,
        _WRENCH_UNITS,
        Role.TRUTH,
        "sensor",
        "true wrench of the payload on the platform, one tick old",
    ),
    _signal("truth.arm_q", _JOINTS, "rad", Role.TRUTH, "joint", "true joint angle"),
    _signal("truth.leg_force", _LEGS, "N", Role.TRUTH, "leg", "force of the cylinder"),
    _signal("truth.leg_bending", _BENDING, "rad", Role.TRUTH, "leg", "bending angles of each leg"),
)

SIGNALS: dict[str, Signal] = {signal.name: signal for signal in _TABLE}
"""Every signal by name, in the order of a recording's columns."""
