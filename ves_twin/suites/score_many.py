"""score_many: names one by one, where many causes are hidden beside some outside the library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ves_twin.suites.answers import Answer
from ves_twin.suites.judgement import NAMES
from ves_twin.suites.model_error import Family
from ves_twin.suites.rate import Rate
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

LARGE = 0.10
"""Share of its column's rms from which a hidden cause should be found."""

TOGETHER = " + "
"""Between names that an answer says act together as one cause does."""


@dataclass(frozen=True)
class _Name:
    """One name that was said: right if it is hidden, or has the columns of a hidden cause."""

    label: str
    firm: bool
    right: bool
    meant: bool


def score_many(both: Sequence[tuple[Truth, Answer]]) -> dict[str, Rate]:
    """Count over all names and all hidden causes of cases with many.

    A name is false if it is not hidden and no hidden cause has its columns (`Likes`, told before
    the answers). It is false by all that is said if what it is said to act like is so, too.
    """
    rows: dict[str, Rate] = {}
    for family in Family:
        cases = [(t, a) for t, a in both if t.family is family]
        names = [name for truth, answer in cases for name in _names(truth, answer)]
        large = [
            (cause, _said(answer))
            for t, answer in cases
            for cause in t.causes
            if cause.share >= LARGE
        ]
        firm = [name for name in names if name.firm]
        what = f"many, {family}"
        rows |= {
            f"{what}: causes of {LARGE:.0%} or more found": Rate.over(large, lambda p: _found(*p)),
            f"{what}: those by their own name": Rate.over(large, lambda p: p[0].label in p[1]),
            f"{what}: names that are false": Rate.over(names, lambda name: not name.right),
            f"{what}: names that are false by all that is said": Rate.over(
                names, lambda name: not (name.right or name.meant)
            ),
            f"{what}: firm names that are false": Rate.over(firm, lambda name: not name.right),
            f"{what}: 90 % intervals that hold the hidden size": _covered(cases),
        }
    every = [(t, a) for t, a in both if t.hidden is Hidden.MANY]
    rows["many: 90 % intervals that hold the hidden size"] = _covered(every)
    own = [(t, c) for t, a in every for c in t.causes if c.label in _said(a)]
    rows["many: sizes of which only a sum can be known"] = Rate.over(own, lambda p: _shared(*p))
    return rows


def _said(answer: Answer) -> Sequence[str]:
    """Names for good."""
    return answer.causes if answer.verdict in NAMES else ()


def _names(truth: Truth, answer: Answer) -> list[_Name]:
    right = {label for cause in truth.causes for label in (cause.label, *cause.likes)}
    like = answer.acts_like or {}
    found = []
    for label, firm in zip(_said(answer), answer.firm, strict=False):
        others = {part for one in like.get(label, ()) for part in one.split(TOGETHER)}
        found.append(_Name(label, firm, label in right, bool(others & right)))
    return found


def _shared(truth: Truth, cause: HiddenCause) -> bool:
    """Whether another hidden cause has the columns of one."""
    return any(one.label in cause.likes for one in truth.causes)


def _found(cause: HiddenCause, said: Sequence[str]) -> bool:
    return bool({cause.label, *cause.likes} & set(said))


def _covered(cases: Sequence[tuple[Truth, Answer]]) -> Rate:
    """Intervals of the causes that are called by their own name.

    Not of one that has the columns of another hidden one: only the sum of both can be known.
    """
    inside = []
    for truth, answer in cases:
        said = set(_said(answer))
        known = (one for one in truth.causes if not _shared(truth, one))
        for cause in (one for one in known if one.label in said):
            for name, departure in cause.departures.items():
                if (size := (answer.sizes or {}).get(name)) is None:
                    continue
                _, low, high, nominal = size
                inside.append(low <= truth.values.get(name, nominal + departure) <= high)
    return Rate(sum(inside), len(inside))
