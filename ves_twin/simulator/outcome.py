"""Outcome: the named ways in which a run can end."""

from __future__ import annotations

from enum import StrEnum

from ves_twin.simulator.codes import LEG_AT_LIMIT, NOT_FINITE, WRENCH_OUT_OF_RANGE


class Outcome(StrEnum):
    """How a run ended; `advice` tells what to try."""

    COMPLETED = "completed"
    DIVERGED = "diverged"
    LEG_LIMIT = "leg_limit"
    WRENCH_RANGE = "wrench_range"
    OVERRUN = "overrun"
    CEILING = "ceiling"
    INTERRUPTED = "interrupted"

    @property
    def advice(self) -> str:
        """What the outcome means and what to try."""
        return _ADVICE[self]


_ADVICE = {
    Outcome.COMPLETED: "the run reached its end",
    Outcome.DIVERGED: "the state is no longer finite; try more run.substeps or lower gains",
    Outcome.LEG_LIMIT: "a leg reached its limit; the loop may be unstable (lower legs.gain, a"
    " heavier emulated mass) or the motion too large",
    Outcome.WRENCH_RANGE: "the force sensor left its range; check payload and arm motion",
    Outcome.OVERRUN: "the clock interrupt came before the cycle had ended; lower platform.rate",
    Outcome.CEILING: "the arm hit the ceiling; move it away before the platform goes home",
    Outcome.INTERRUPTED: "stopped from the keyboard",
}

OUTCOME_OF_CODE = {
    NOT_FINITE: Outcome.DIVERGED,
    LEG_AT_LIMIT: Outcome.LEG_LIMIT,
    WRENCH_OUT_OF_RANGE: Outcome.WRENCH_RANGE,
}
