"""LAW_PLACES, parse_laws: where laws may act on VES II, and those of a plant's file."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from ves_twin.core.part import Part
from ves_twin.core.refusal import refusal
from ves_twin.core.signals import SIGNALS
from ves_twin.effects.law_table import LawTable
from ves_twin.effects.row import JOINTS, LEGS

PLATFORM = tuple(f"platform.{axis}" for axis in ("x", "y", "z", "rx", "ry", "rz"))
"""Force on the platform's origin along the inertial axes, moment about its own."""

LAW_PLACES = (*LEGS, *JOINTS, *PLATFORM)
"""Where an effort may act: rods, joints of the arm, platform. A place's number is its index."""

COMMANDED = (*LEGS, *JOINTS)
"""Those with a command: current of the valve, -1 to 1, and torque of the drive [N m]."""

READ = ("leg.length", "sensor.wrench", "arm.q", "arm.torque", "supply.pressure")
"""Signals whose columns may be read otherwise than they are."""

COLUMNS = tuple(column for name in READ for column in SIGNALS[name].columns)

VARIABLES = (
    "time",
    *(f"position@{name}" for name in LAW_PLACES),
    *(f"speed@{name}" for name in LAW_PLACES),
    *(f"command@{name}" for name in COMMANDED),
)


class _Laws(Part):
    """The laws of a plant's file."""

    laws: tuple[LawTable, ...] = ()


def parse_laws(content: object, path: Path) -> tuple[LawTable, ...]:
    """Laws of a file's `[[laws]]`.

    Raises:
        UnknownNameError: a key, place or variable that VES II does not have; says the nearest one.
        InvalidInputError: a law that is none; says the key.
    """
    try:
        found = _Laws.model_validate({"laws": content}).laws
    except ValidationError as error:
        raise refusal(error, path.name, _Laws) from None
    for law in found:
        law.check(LAW_PLACES, COLUMNS, VARIABLES)
    return found
