"""Verdict: what the twin says of a claim, by one comparison for all claims."""

from __future__ import annotations

from enum import StrEnum

from ves_twin.thesis.claim import Claim, Kind
from ves_twin.thesis.evaluation import Found, NotBuilt, NotRun, NotTestable


class Verdict(StrEnum):
    """How a claim came out.

    `input`: given to the twin, which has it as given. `reproduced`: within the tolerance.
    `in kind`: says the same as the thesis's words, or as its number less sharply. `differs`:
    neither. `not built`: the twin lacks what would answer. `not testable`: no twin can answer.
    `not run`: in a quick scorecard, what only the full run tells.
    """

    INPUT = "input"
    REPRODUCED = "reproduced"
    IN_KIND = "in kind"
    DIFFERS = "differs"
    NOT_BUILT = "not built"
    NOT_TESTABLE = "not testable"
    NOT_RUN = "not run"


def judge(claim: Claim, found: Found) -> Verdict:
    """The verdict on a claim; the only place where one is made."""
    if isinstance(found, NotBuilt):
        return Verdict.NOT_BUILT
    if isinstance(found, NotTestable):
        return Verdict.NOT_TESTABLE
    if isinstance(found, NotRun):
        return Verdict.NOT_RUN
    compared = (found.values, claim.expected, found.holds)
    if claim.tolerance is not None and claim.tolerance.met(*compared):
        return Verdict.INPUT if claim.kind is Kind.INPUT else Verdict.REPRODUCED
    if claim.in_kind is not None and claim.in_kind.met(*compared):
        return Verdict.IN_KIND
    return Verdict.DIFFERS
