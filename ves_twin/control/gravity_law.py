"""LAW of gravity: what the compiled cycle runs of a gravity compensation."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray, Record
from ves_twin.mechanics.gravity.quick_gravity import QuickGravity, in_sensor

KNOWN, MODEL, TRUTH = 0, 1, 2
"""Kinds: an estimate that no reading changes, asked of the compensation ahead; the Model Method;
the plant's own wrench."""

LAW = np.dtype(
    [
        ("kind", np.int64),
        ("rows", np.float64, (3, 6)),
        ("base", np.float64, (4, 4)),
        ("links", np.float64, (4, 4)),
        ("total_mass", np.float64),
        ("gravity", np.float64),
        ("position", np.float64, 3),
        ("pose", np.float64, 6),
        ("scaled", np.int64),
        ("factor", np.float64),
        ("since", np.float64),
        ("corrected", np.int64),
        ("correction", np.float64, 6),
    ]
)
"""kind; the numbers of `QuickGravity`; origin of the sensor in the top frame [m]; the pose found
last [m, rad]; whether and by which factor the estimate is wrong from a time on [s]; whether and
which wrench is added [N, N m]."""


KNOWN_LAW: Block = np.zeros(1, LAW)
"""Of an estimate that depends on time alone."""


TRUTH_LAW: Block = KNOWN_LAW.copy()
TRUTH_LAW["kind"] = TRUTH


def model_law(model: QuickGravity, position: FloatArray) -> Block:
    """The Model Method with the sensor's origin at a position in the top frame [m] (3,)."""
    law = np.zeros(1, LAW)
    law["kind"] = MODEL
    for name in ("rows", "base", "links", "total_mass", "gravity"):
        law[name] = getattr(model, name)
    law["position"] = position
    return law


def scaled_law(law: Block | None, factor: float, since: float | None) -> Block | None:
    """The law with its estimate times a factor from a time on [s]; None where it cannot be."""
    if law is None or law is KNOWN_LAW:
        return law
    if law["scaled"] or law["corrected"]:
        return None
    law["scaled"], law["factor"] = True, factor
    law["since"] = -np.inf if since is None else since
    return law


def corrected_law(law: Block | None) -> Block | None:
    """The law with its field `correction` added last; None where it cannot be."""
    if law is None or law is KNOWN_LAW:
        return law
    if law["corrected"]:
        return None
    law["corrected"] = True
    return law


@compiled
def model_wrench(block: Block, q: FloatArray, angles: FloatArray) -> FloatArray:
    """Wrench of the Model Method, sensor axes [N, N m] (6,).

    Args:
        block: LAW (1,).
        q: measured joint angles [rad] (3,).
        angles: of the platform, fixed axes [rad] (3,).
    """
    law = block[0]
    return in_sensor(
        law.rows, law.base, law.links, law.total_mass, law.gravity, q, angles, law.position
    )


@compiled
def changed(law: Record, time: float, wrench: FloatArray) -> FloatArray:
    """A wrench (6,) with what is wrong with it on purpose at a time [s]."""
    if law.scaled and not time < law.since:
        wrench = law.factor * wrench
    if law.corrected:
        wrench = wrench + law.correction
    return wrench
