"""cylinder: linear hydraulics, an oil column that the valve moves and that pushes the rod."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record

PARAMETERS = np.dtype(
    [("full_speed", np.float64), ("stiffness", np.float64, 6), ("damping", np.float64, 6)]
)
"""full_speed: rod speed at full opening [m/s]; stiffness [N/m] and damping [N s/m] of
the oil of each leg."""

STATE = np.dtype([("column", np.float64, 6)])
"""column: rod position at which the oil carries no load [m]."""


@compiled
def push_rods(
    p: Record,
    s: Record,
    force: FloatArray,
    spool: FloatArray,
    slide: FloatArray,
    speed: FloatArray,
    step: float,
) -> None:
    """Rod forces F = k (x - q) - c q', then the oil column moves by full_speed * spool * h.

    The small-signal limit of a servovalve with two chambers: flow integrates to position and
    the trapped oil is a spring. Leakage and supply are those of
    the pressure form; dry friction is a joint friction of the engine.

    Args:
        p: PARAMETERS.
        s: STATE.
        force: result [N] (6,).
        spool: mean opening over the step, -1 to 1 (6,).
        slide: rod travel from home q [m] (6,).
        speed: rod speed q' [m/s] (6,).
        step: physics step h [s].
    """
    for i in range(6):
        force[i] = p.stiffness[i] * (s.column[i] - slide[i]) - p.damping[i] * speed[i]
        s.column[i] += p.full_speed * spool[i] * step
