"""turned: vectors of the world in the frame of a quaternion signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray


def turned(
    values: FloatArray, signals: Mapping[str, FloatArray], name: str, frame: str
) -> FloatArray:
    """Vectors (n, 3) of the world in the frame of a signal that ends in a quaternion (x, y, z, w).

    Args:
        values: in the world.
        signals: that hold the frame's.
        name: of the vector, for messages.
        frame: name of the signal with the quaternion, sensor to world.

    Raises:
        UnknownNameError: no such signal.
        InvalidInputError: other numbers of columns.
    """
    if frame not in signals:
        raise UnknownNameError(f"signal that {name} is turned into", frame, signals)
    if values.shape[1] != 3 or signals[frame].shape[1] not in (4, 7):
        shapes = (values.shape[1], signals[frame].shape[1])
        raise InvalidInputError(f"columns of {name} and {frame}", shapes, "3 and 4 (or 7)")
    turns = Rotation.from_quat(signals[frame][:, -4:])
    return np.asarray(turns.inv().apply(values))
