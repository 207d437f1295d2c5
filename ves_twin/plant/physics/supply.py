"""supply: the manifold that six valves share, fed by a pump with droop and an accumulator."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import Record
from ves_twin.plant.physics.chambers import growth

PARAMETERS = np.dtype(
    [
        ("pressure", np.float64),
        ("droop", np.float64),
        ("flow_limit", np.float64),
        ("compliance", np.float64),
    ]
)
"""pressure: of the source without flow P0 [Pa]; droop: pressure lost per flow R [Pa s/m^3], 0 for
a manifold that holds P0; flow_limit: most that the pump gives [m^3/s]; compliance: oil stored per
pressure by the accumulator C [m^3/Pa]."""

STATE = np.dtype([("manifold", np.float64)])
"""manifold: pressure at the valves [Pa]."""


@compiled
def feed_manifold(p: Record, s: Record, demand: float, slope: float, step: float) -> None:
    """Advance the manifold pressure by a step.

        P' = (Qs - Q) / C,  Qs = min((P0 - P) / R, limit)

    so that P0 - P = R Q in steady flow, and the pressure falls until the valves draw no more than
    the limit. Oil that loads push back goes out by the same line, as through a relief valve.
    Without droop P stays P0 and neither limit nor accumulator acts. Exponential in its own slope.

    Args:
        p: PARAMETERS.
        s: STATE.
        demand: flow Q that the legs draw [m^3/s].
        slope: dQ/dP [m^3/s/Pa].
        step: physics step h [s].
    """
    if p.droop == 0.0:
        s.manifold = p.pressure
        return
    source, stiffness = (p.pressure - s.manifold) / p.droop, 1.0 / p.droop
    if source > p.flow_limit:
        source, stiffness = p.flow_limit, 0.0
    decay = -(stiffness + slope) / p.compliance
    rate = (source - demand) / p.compliance
    s.manifold = max(s.manifold + step * rate * growth(decay * step), 0.0)
