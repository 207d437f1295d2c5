"""operator_motion: joint commands of an operator from a file, CSV or Parquet."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.resources import find_resource
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import RecordedJoints
from ves_twin.scenario.columns import read_columns
from ves_twin.scenario.fields import TURNS

COLUMNS = ("t", "q1", "q2", "q3")
"""Time [s] and joint angles [rad]."""

NEAR = 1e-3
"""How far the first command may lie from the arm's start [rad]: ten counts of the encoders."""


def operator_motion(name_or_path: str, start: FloatArray) -> RecordedJoints:
    """What an operator commanded, for an arm that stands at `start` [rad] (3,).

    Args:
        name_or_path: a name of scenarios/data/, or a path to a .csv or .parquet file with the
            columns t [s], q1, q2, q3 [rad].
        start: joint angles of the scenario.

    Raises:
        FileAccessError: missing or unreadable.
        UnknownNameError: no such name; says the nearest one.
        InvalidInputError: columns missing, no numbers, times that do not increase, or commands
            that do not begin where the arm stands.
    """
    path = find_resource("operator file", "scenarios/data", name_or_path, ".csv")
    rows, _ = read_columns("operator file", path, COLUMNS)
    time, angles = rows[:, 0], rows[:, 1:]
    if len(rows) < 2 or np.any(np.diff(time) <= 0.0):
        raise InvalidInputError(f"{path.name}: t", f"{len(rows)} rows", "two or more, increasing")
    if np.max(np.abs(angles)) > TURNS:
        raise InvalidInputError(
            f"{path.name}: q", float(np.max(np.abs(angles))), "angles in radians, within two turns"
        )
    if np.max(np.abs(angles[0] - start)) > NEAR:
        first = [round(float(angle), 4) for angle in angles[0]]
        raise InvalidInputError(f"{path.name}: first row", first, f"arm.start, {start.tolist()}")
    return RecordedJoints.through(time, angles)
