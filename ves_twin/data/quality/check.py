"""Check: one question to a recording, and what it answered."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Grade(StrEnum):
    """Answer of a check; `unknown` where the recording holds too little to tell."""

    PASSED = "pass"
    FAILED = "fail"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Check:
    """One check of a recording.

    Attributes:
        name: what was asked, for instance "gaps".
        grade: the answer.
        signals: signals or columns that it is about; empty for the recording as a whole.
        message: one line that says what was found and what was expected.
    """

    name: str
    grade: Grade
    signals: tuple[str, ...]
    message: str


def passed(name: str, message: str, *signals: str) -> Check:
    """A check that found nothing wrong."""
    return Check(name, Grade.PASSED, signals, message)


def failed(name: str, message: str, *signals: str) -> Check:
    """A check that found something wrong."""
    return Check(name, Grade.FAILED, signals, message)


def unknown(name: str, message: str, *signals: str) -> Check:
    """A check that cannot tell."""
    return Check(name, Grade.UNKNOWN, signals, message)
