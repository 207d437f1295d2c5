"""judge: one answer beside what was hidden, in a word."""

from __future__ import annotations

from collections.abc import Set
from enum import StrEnum

from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.suites.answers import Answer

NAMES = frozenset(kind.value for kind in Kind if kind.names_a_plant)
"""Verdicts that name causes for good."""


class Judgement(StrEnum):
    """How an answer stands to what was hidden.

    group: the truth is among causes that are said to be indistinguishable. part: some of what was
    hidden, and nothing else. withheld: something was seen, and no name given.
    """

    RIGHT = "right"
    GROUP = "right, in a group that the recording cannot part"
    PART = "part of it"
    WITHHELD = "no name given"
    MISSED = "missed"
    WRONG = "wrong"


def judge(answer: Answer, hidden: Set[str], outside: bool) -> Judgement:
    """Hold an answer against the truth.

    Args:
        answer: what was said.
        hidden: effect@target of every hidden cause of the library.
        outside: whether something was hidden that the library lacks.
    """
    labels, there = list(answer.causes), bool(hidden or outside)
    if answer.verdict == Kind.NOTHING:
        return Judgement.MISSED if there else Judgement.RIGHT
    if answer.verdict == Kind.AMBIGUOUS:
        groups = [{labels[i] for i in numbers} for numbers in answer.alternatives]
        return Judgement.GROUP if hidden in groups and not outside else Judgement.WRONG
    if answer.verdict not in NAMES:
        seen = Judgement.RIGHT if outside else Judgement.WITHHELD
        return seen if there else Judgement.WRONG
    if set(labels) == hidden and not outside and answer.verdict != Kind.PARTIAL:
        return Judgement.RIGHT
    return Judgement.PART if set(labels) <= hidden else Judgement.WRONG
