"""turn_signal: a vector or wrench from the axes it was recorded in to those of the signal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.signals import Signal
from ves_twin.core.types import FloatArray


def rotation_of(axes: Sequence[str]) -> FloatArray:
    """Rotation (3, 3) with v_signal = R v_recorded; axes as ("y", "-x", "z")."""
    rotation = np.zeros((3, 3))
    for row, axis in enumerate(axes):
        rotation[row, "xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    return rotation


def handedness(axes: Sequence[str]) -> int:
    """1 for a right-handed frame, -1 for a mirrored one, 0 for axes that repeat."""
    return round(float(np.linalg.det(rotation_of(axes))))


def turn_signal(
    values: FloatArray, signal: Signal, axes: Sequence[str], origin: Sequence[float]
) -> FloatArray:
    """Values (n, width) in the signal's own frame.

    A wrench about another point moves with F' = R F, M' = R M + r x F', r the recorded point.

    Args:
        values: a vector (n, 3), or force and moment (n, 6).
        signal: what it is.
        axes: recorded axis with its sign for each axis of the signal.
        origin: point that the wrench was recorded about, in the signal's frame [m].

    Raises:
        InvalidInputError: a signal that is neither, or an origin for one without moments.
    """
    wrench = signal.width == 6 and signal.units[3:] == ("N*m",) * 3
    if not wrench and (signal.width != 3 or any(origin)):
        came = f"{signal.name} with {signal.width} columns in {', '.join(signal.units)}"
        raise InvalidInputError("frame", came, "a wrench, or a vector without an origin")
    rotation = rotation_of(axes)
    turned = values.copy()
    turned[:, :3] = values[:, :3] @ rotation.T
    if wrench:
        turned[:, 3:] = values[:, 3:] @ rotation.T + np.cross(np.asarray(origin), turned[:, :3])
    return turned
