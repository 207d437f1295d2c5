"""TrackingError: how far the platform was from where it was commanded to be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.scenario.schema import Scenario


@dataclass(frozen=True)
class TrackingError:
    """Tracking error of one axis: the legs' lag, above all.

    Attributes:
        rms: root mean square of truth less command [m or rad].
        peak: its largest magnitude [m or rad].
        relative: peak over the largest norm of the commanded translation (or rotation) from
            home; None where nothing is commanded.
    """

    rms: float
    peak: float
    relative: float | None


Rows = tuple[FloatArray, FloatArray]
"""Some rows of `truth.pose` and `platform.command`, (n, 6) each."""


def tells_tracking(scenario: Scenario) -> bool:
    """Whether command and pose of a run are to agree.

    Where a base is emulated the zero-g reference is what counts; where an operator acts, legs
    without current are commanded nothing.
    """
    return scenario.platform.emulated is None and scenario.operation is None


def tracking_error(
    parts: Iterable[Rows], home: FloatArray | None = None
) -> dict[str, TrackingError]:
    """Error per axis of `truth.pose` against `platform.command`.

    Args:
        parts: the rows of a run, in as many parts as one likes [m, rad].
        home: platform pose from which motion counts (6,); zero if left out.

    Returns:
        Axis name (x, y, z, rx, ry, rz) -> error; empty without a row, or where one is not finite.
    """
    count, size = 0, np.zeros(2)
    squares, peak = np.zeros(6), np.zeros(6)
    for truth, command in parts:
        error = truth - command
        count += len(error)
        squares += np.sum(error**2, axis=0)
        peak = np.maximum(peak, np.max(np.abs(error), axis=0, initial=0.0))
        motion = command if home is None else command - home
        norms = [np.linalg.norm(motion[:, k : k + 3], axis=1) for k in (0, 3)]
        size = np.maximum(size, [np.max(norm, initial=0.0) for norm in norms])
    if count == 0 or not np.all(np.isfinite(squares)):
        return {}
    rms = np.sqrt(squares / count)
    return {
        axis: TrackingError(
            rms=float(rms[i]),
            peak=float(peak[i]),
            relative=float(peak[i] / size[i // 3]) if size[i // 3] > 0 else None,
        )
        for i, axis in enumerate(SIGNALS["truth.pose"].axes)
    }
