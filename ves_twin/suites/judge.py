"""judge: one verdict beside one truth, in a word."""

from __future__ import annotations

from enum import StrEnum

from ves_twin.diagnosis.verdict import Kind, Verdict


class Judgement(StrEnum):
    """How a verdict stands to what was hidden.

    group: the truth is among causes that are said to be indistinguishable. part: some of what was
    hidden, and nothing else. withheld: something was seen, and no name given.
    """

    RIGHT = "right"
    GROUP = "right, in a group that the recording cannot part"
    PART = "part of it"
    WITHHELD = "no name given"
    MISSED = "missed"
    WRONG = "wrong"


def judge(verdict: Verdict, hidden: frozenset[str], outside: bool) -> Judgement:
    """Hold a verdict against the truth.

    Args:
        verdict: what was said.
        hidden: effect@target of every hidden cause of the library.
        outside: whether something was hidden that the library lacks.
    """
    labels = [f"{cause.effect}@{cause.target}" for cause in verdict.causes]
    match verdict.verdict:
        case Kind.NOTHING:
            return Judgement.MISSED if hidden or outside else Judgement.RIGHT
        case Kind.UNKNOWN if not hidden and not outside:
            return Judgement.WRONG
        case Kind.UNKNOWN:
            return Judgement.RIGHT if outside else Judgement.WITHHELD
        case Kind.AMBIGUOUS:
            groups = [{labels[i] for i in numbers} for numbers in verdict.alternatives]
            return Judgement.GROUP if hidden in groups and not outside else Judgement.WRONG
    if set(labels) == hidden and not outside and verdict.verdict is not Kind.PARTIAL:
        return Judgement.RIGHT
    return Judgement.PART if set(labels) <= hidden else Judgement.WRONG
