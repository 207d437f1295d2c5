"""EmulationError: how far the platform was from the zero-g reference, and what the legs explain."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class AxisError:
    """Emulation error of one axis.

    Attributes:
        rms: root mean square of truth less reference [m or rad].
        peak: its largest magnitude [m or rad].
        relative: peak over the peak of the reference's translation (or rotation)
            norm; None where the reference does not move.
        rms_leg_lag: rms that the leg bandwidth alone would cause [m or rad].
        rms_rest: rms of what the leg bandwidth does not explain [m or rad].
    """

    rms: float
    peak: float
    relative: float | None
    rms_leg_lag: float
    rms_rest: float


Rows = tuple[FloatArray, FloatArray, FloatArray]
"""Some rows of `truth.pose`, `reference.pose` and `reference.pose_leg_lag`, (n, 6) each."""


def emulation_error(parts: Iterable[Rows], home: FloatArray | None = None) -> dict[str, AxisError]:
    """Error per axis of `truth.pose` against `reference.pose`.

    Args:
        parts: the rows of a run, in as many parts as one likes, so that a long run need not be
            in memory [m, rad].
        home: platform pose at which the emulated base is at zero (6,); motion is from there.

    Returns:
        Axis name (x, y, z, rx, ry, rz) -> error; empty if there is no row, or a reference that
        is not finite.
    """
    count, size = 0, np.zeros(2)
    squares, peak = np.zeros((3, 6)), np.zeros(6)
    for truth, reference, with_leg_lag in parts:
        error, legs = truth - reference, with_leg_lag - reference
        count += len(error)
        for row, values in zip(squares, (error, legs, error - legs), strict=True):
            row += np.sum(values**2, axis=0)
        peak = np.maximum(peak, np.max(np.abs(error), axis=0, initial=0.0))
        motion = reference if home is None else reference - home
        norms = [np.linalg.norm(motion[:, k : k + 3], axis=1) for k in (0, 3)]
        size = np.maximum(size, [np.max(norm, initial=0.0) for norm in norms])
    if count == 0 or not np.all(np.isfinite(squares)):
        return {}
    rms, rms_legs, rms_rest = np.sqrt(squares / count)
    return {
        axis: AxisError(
            rms=float(rms[i]),
            peak=float(peak[i]),
            relative=float(peak[i] / size[i // 3]) if size[i // 3] > 0 else None,
            rms_leg_lag=float(rms_legs[i]),
            rms_rest=float(rms_rest[i]),
        )
        for i, axis in enumerate(SIGNALS["truth.pose"].axes)
    }
