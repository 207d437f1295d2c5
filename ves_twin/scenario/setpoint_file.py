"""read_setpoints: set-points of legs and arm over time from a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.resources import find_resource
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.scenario.columns import read_columns
from ves_twin.scenario.fields import TURNS

EVEN = 1e-3
"""Share of a period that rows may lie off an even clock."""

FEWEST = 4
"""Rows below which a joint's command has no curvature to go by."""


@dataclass(frozen=True)
class Setpoints(ReadOnly):
    """What was, or is to be, commanded.

    Attributes:
        name: of the file.
        time: of the rows from 0 on, evenly apart [s] (n,).
        legs: commanded lengths [m] (n, 6).
        arm: commanded joint angles [rad] (n, 3); None if the file has none.
    """

    name: str
    time: FloatArray
    legs: FloatArray
    arm: FloatArray | None


def read_setpoints(name_or_path: str) -> Setpoints:
    """Set-points from a name of scenarios/data/, or from a .csv or .parquet file.

    Columns are t [s], leg.command.1 ... 6 [m] and, if the arm moves, arm.command.1 ... 3 [rad]: the
    names that recordings have. A recording's own table is such a file.

    Raises:
        FileAccessError: missing or unreadable.
        UnknownNameError: no such name; says the nearest one.
        InvalidInputError: columns missing, no numbers, or times that are not evenly apart.
    """
    path = find_resource("set-point file", "scenarios/data", name_or_path, ".csv")
    needed = ("t", *SIGNALS["leg.command"].columns)
    rows, (arm,) = read_columns("set-point file", path, needed, SIGNALS["arm.command"].columns)
    time = rows[:, 0] - rows[0, 0] if len(rows) else rows[:, 0]
    steps = np.diff(time)
    if len(time) < FEWEST or np.any(steps <= 0.0) or np.ptp(steps) > EVEN * np.mean(steps):
        expected = f"{FEWEST} or more, evenly apart"
        raise InvalidInputError(f"{path.name}: t", f"{len(time)} rows", expected)
    if arm is not None and np.max(np.abs(arm)) > TURNS:
        worst = float(np.max(np.abs(arm)))
        raise InvalidInputError(f"{path.name}: arm.command", worst, "radians, within two turns")
    return Setpoints(path.name, np.asarray(time), rows[:, 1:], arm)
