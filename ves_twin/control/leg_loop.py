"""leg_loop: length control of the six legs, PD with a second-order digital section."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, Record

PARAMETERS = np.dtype(
    [
        ("gain", np.float64),
        ("rate_gain", np.float64),
        ("limit", np.float64),
        ("place", np.int64),
        ("edge", np.float64),
        ("numerator", np.float64, 3),
        ("denominator", np.float64, 3),
        ("period", np.float64),
        ("full_speed", np.float64),
    ]
)
"""gain [1/s]; rate_gain on the measured speed [1]; limit of the commands; place of the section,
its edge [Hz] and the coefficients that follow from it; period [s];
full_speed: rod speed believed at full opening [m/s]."""

STATE = np.dtype(
    [
        ("z1", np.float64, 6),
        ("z2", np.float64, 6),
        ("previous", np.float64, 6),
        ("command", np.float64, 6),
    ]
)
"""Registers of the section, length one leg cycle ago [m], commanded length [m]."""

NONE, ERROR, FEEDBACK = 0, 1, 2


class FilterPlace(StrEnum):
    """Which signal of the leg loop the digital section filters (thesis figs. 5-4, 5-9)."""

    NONE = "none"
    ERROR = "error"
    FEEDBACK = "feedback"

    @property
    def code(self) -> int:
        """Number of the place in the compiled kernel."""
        return {FilterPlace.NONE: NONE, FilterPlace.ERROR: ERROR}.get(self, FEEDBACK)


EDGE = 9.0
"""Edge of the thesis's leg filter [Hz] (Table 5-1, errata E-43)."""


def chebyshev_section(rate: float, edge: float = EDGE) -> tuple[FloatArray, FloatArray]:
    """The thesis's leg filter: Chebyshev type 2, second order, 4 dB from its edge up.

    Args:
        rate: sampling rate of the leg loop [Hz].
        edge: where the stop band begins [Hz]; the notch lies at sqrt(2) of it.

    Raises:
        InvalidInputError: a rate below twice the edge.

    Returns:
        Numerator and denominator, (3,) each; at 587 Hz the digits of Table 5-1.

    Source: thesis Table 5-1, errata E-43, E-44.
    """
    from scipy.signal import cheby2  # slow to import

    if rate <= 2.0 * edge:
        raise InvalidInputError(
            "rate of the leg loop", rate, f"more than {2.0 * edge:g} Hz, twice the edge"
        )
    numerator, denominator = cheby2(2, 4.0, edge, fs=rate)
    return np.asarray(numerator), np.asarray(denominator)


@compiled
def start_legs(p: Record, s: Record, length: FloatArray) -> None:
    """Put the loop into the steady state of legs that stand at their command (6,) [m]."""
    b, a = p.numerator, p.denominator
    for i in range(6):
        x = length[i] if p.place == FEEDBACK else 0.0
        s.z2[i] = (b[2] - a[2]) * x
        s.z1[i] = (b[1] - a[1]) * x + s.z2[i]
        s.previous[i] = length[i]
        s.command[i] = length[i]


@compiled
def control_legs(p: Record, s: Record, length: FloatArray, valve: FloatArray) -> None:
    """Spool commands u = (gain * e - rate_gain * dL/dt) / full_speed, within +-limit.

    The section filters the error, the measured length, or nothing; its gain at rest is 1. The
    rate term uses the measured speed: on the error it would see the steps of the command.

    Args:
        p: PARAMETERS.
        s: STATE, with the commanded lengths.
        length: measured lengths [m] (6,).
        valve: result (6,).

    Source: thesis 5.2 to 5.4; facts on K1 and K2 are calibrated, see models/ves2.toml.
    """
    b, a = p.numerator, p.denominator
    for i in range(6):
        error = s.command[i] - length[i]
        if p.place != NONE:
            x = length[i] if p.place == FEEDBACK else error
            y = b[0] * x + s.z1[i]
            s.z1[i] = b[1] * x - a[1] * y + s.z2[i]
            s.z2[i] = b[2] * x - a[2] * y
            error = s.command[i] - y if p.place == FEEDBACK else y
        speed = (length[i] - s.previous[i]) / p.period
        s.previous[i] = length[i]
        u = (p.gain * error - p.rate_gain * speed) / p.full_speed
        valve[i] = min(max(u, -p.limit), p.limit)
