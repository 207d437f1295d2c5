"""transducer: magnetostrictive leg length transducer, one reading each tick."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record, SingleArray

PARAMETERS = np.dtype(
    [
        ("home", np.float64, 6),
        ("scale", np.float64, 6),
        ("noise", np.float64),
        ("resolution", np.float64),
    ]
)
"""home: length at zero slide [m]; scale: reading per travel [1]; noise: white sd per sample [m];
resolution [m]."""


@compiled
def read_lengths(p: Record, slide: FloatArray, normal: SingleArray, length: FloatArray) -> None:
    """Leg lengths as the cards report them: home + scale * slide + noise, in whole counts.

    Bending of the leg is invisible to it: the magnet rides on the rod inside the cylinder.

    Args:
        p: PARAMETERS.
        slide: rod travel from home [m] (6,).
        normal: standard normal numbers (6,).
        length: result [m] (6,).

    Source: thesis 2.4.1, errata E-5.
    """
    for i in range(6):
        value = p.home[i] + p.scale[i] * slide[i] + p.noise * normal[i]
        if p.resolution > 0.0:
            value = np.rint(value / p.resolution) * p.resolution
        length[i] = value
