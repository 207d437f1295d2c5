"""value_words, thesis_words, asked_words: numbers of a row as a person reads them."""

from __future__ import annotations

import numpy as np

from ves_twin.thesis.claim import Claim
from ves_twin.thesis.evaluation import Evaluation
from ves_twin.thesis.row import Row

LONGEST = 6
"""More values than these are told by their largest deviation; JSON has them all."""

TINY = 1e-15
"""What counts as zero beside values of order one."""


def value_words(row: Row) -> str:
    """The twin's values with their unit."""
    return _values(row.found, row.claim)


def predicted_words(row: Row) -> str:
    """The leave-one-out prediction's values with their unit; empty where there is none."""
    return _values(row.predicted, row.claim)


def thesis_words(claim: Claim) -> str:
    """The printed value with its unit, and what the errata make of it."""
    words = claim.printed
    if _single(claim.unit) and words[-1].isdigit():
        words += f" {claim.unit}"
    if claim.corrected:
        right = "" if len(claim.corrected) > LONGEST else f" {_list(claim.corrected)}"
        words += f" (corrected{right}, {', '.join(claim.errata)})"
    elif claim.errata:
        words += f" ({', '.join(claim.errata)})"
    return words


def asked_words(claim: Claim) -> str:
    """What the verdict asks: the tolerance, and what suffices to be the same in kind."""
    parts = []
    if claim.tolerance is not None:
        parts.append(claim.tolerance.words(claim.unit))
    if claim.in_kind is not None:
        parts.append(f"in kind {claim.in_kind.words(claim.unit)}")
    return "; ".join(dict.fromkeys(parts))


def _values(found: object, claim: Claim) -> str:
    if not isinstance(found, Evaluation):
        return ""
    values = found.values
    if not values:
        return "" if found.holds is None else "yes" if found.holds else "no"
    if len(values) > LONGEST:
        expected = np.asarray(claim.expected)
        worst = np.max(np.abs(np.asarray(values) - expected)) if len(expected) else np.nan
        return f"{len(values)} values, largest deviation {_number(float(worst))}"
    return f"{_list(values)} {claim.unit}" if _single(claim.unit) else _list(values)


def _single(unit: str) -> bool:
    """Whether all values have one unit that is worth a word."""
    return unit != "1" and "," not in unit


def _list(values: tuple[float, ...]) -> str:
    return ", ".join(_number(value) for value in values)


def _number(value: float) -> str:
    return "0" if abs(value) < TINY else f"{value:.5g}" if abs(value) >= 1e-4 else f"{value:.1e}"
