"""EmulationError: how far the platform was from the zero-g reference, and what the legs explain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.signals import SIGNALS
from ves_twin.types import FloatArray


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


def emulation_error(
    truth: FloatArray, reference: FloatArray, with_leg_lag: FloatArray
) -> dict[str, AxisError]:
    """Error per axis of `truth.pose` against `reference.pose`.

    Args:
        truth: true platform pose [m, rad] (n, 6).
        reference: pose of the zero-g reference (n, 6).
        with_leg_lag: pose of the reference whose platform follows through the legs (n, 6).

    Returns:
        Axis name (x, y, z, rx, ry, rz) -> error.
    """
    error = truth - reference
    legs = with_leg_lag - reference
    size = np.repeat(
        [np.max(np.linalg.norm(part, axis=1)) for part in (reference[:, :3], reference[:, 3:])], 3
    )
    result = {}
    for i, axis in enumerate(SIGNALS["truth.pose"].axes):
        peak = float(np.max(np.abs(error[:, i])))
        result[axis] = AxisError(
            rms=_rms(error[:, i]),
            peak=peak,
            relative=peak / float(size[i]) if size[i] > 0 else None,
            rms_leg_lag=_rms(legs[:, i]),
            rms_rest=_rms(error[:, i] - legs[:, i]),
        )
    return result


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
