"""mark_suite: answers against the truth: counts, Wilson intervals, confusions, by size in sigma."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

from scipy.stats import binomtest

from ves_twin.blind.answer import Answer
from ves_twin.blind.seal import unseal
from ves_twin.blind.suite import load_suite
from ves_twin.blind.truth import Hidden, Truth
from ves_twin.errors import FileAccessError, InvalidInputError

Case = TypeVar("Case")

NAMES = frozenset({"named", "several", "partial"})
"""Verdicts that name causes for good."""

BINS = (0.0, 6.0, 10.0, 20.0, float("inf"))
"""Sizes in sigma that are counted apart."""


@dataclass(frozen=True)
class Rate:
    """How often, of how many, with the 95 % Wilson interval."""

    hits: int
    of: int

    @property
    def interval(self) -> tuple[float, float]:
        """95 % (Wilson); 0 to 1 of none."""
        if self.of == 0:
            return 0.0, 1.0
        found = binomtest(self.hits, self.of).proportion_ci(0.95, method="wilson")
        return float(found.low), float(found.high)

    def __str__(self) -> str:
        low, high = self.interval
        share = f"{self.hits / self.of:.0%}" if self.of else "-"
        return f"{self.hits} of {self.of} ({share}; {low:.0%} to {high:.0%})"


@dataclass(frozen=True)
class Marks:
    """How a set of answers did.

    Attributes:
        rows: what is counted -> rate.
        confusions: (true label, answered label) -> count, of single causes.
        reliability: stated probability from-to -> rate of being right.
        coverage: 90 % intervals that hold the hidden size.
        seconds: median time by sort of case.
    """

    rows: Mapping[str, Rate]
    confusions: Mapping[tuple[str, str], int]
    reliability: Mapping[str, Rate]
    coverage: Rate
    seconds: Mapping[str, float]


def read_truths(folder: Path, key: str) -> list[Truth]:
    """Open the sealed truths of a suite.

    Raises:
        FileAccessError: a truth is missing.
        InvalidInputError: the key does not open it.
    """
    truths = []
    for case in load_suite(folder).cases:
        path = folder / case / "truth.sealed"
        try:
            content = path.read_bytes()
        except OSError as error:
            raise FileAccessError(f"cannot read {path}: {error.strerror}") from None
        truths.append(Truth.from_json(unseal(content, key, str(path))))
    return truths


def mark(truths: Sequence[Truth], answers: Mapping[str, Answer]) -> Marks:
    """Mark anybody's answers; a case without one is not counted.

    Raises:
        InvalidInputError: no case is answered.
    """
    both = [(t, answers[t.case]) for t in truths if t.case in answers]
    if not both:
        raise InvalidInputError("answers", f"cases {sorted(answers)[:3]}", "cases of the suite")
    rows: dict[str, Rate] = {}
    none = [a for t, a in both if t.hidden is Hidden.NONE]
    rows["nothing hidden: nothing said"] = _rate(none, lambda a: a.verdict == "nothing")
    rows["nothing hidden: firm false name"] = _rate(none, _firm)
    rows["nothing hidden: false unknown"] = _rate(none, lambda a: a.verdict == "unknown")
    single = [(t, a) for t, a in both if t.hidden is Hidden.SINGLE]
    for low, high in pairwise(BINS):
        some = [pair for pair in single if low <= pair[0].d < high]
        if some:
            rows[f"single, d {low:g} to {high:g}: exact"] = _rate(some, _exact)
    named = [pair for pair in single if pair[1].verdict in NAMES]
    rows["single: right if named"] = _rate(named, _exact)
    heard = [pair for pair in single if pair[1].verdict in {*NAMES, "ambiguous"}]
    rows["single and detected: truth among the causes"] = _rate(heard, _holds)
    outside = [(t, a) for t, a in both if t.hidden is Hidden.OUTSIDE and a.verdict != "nothing"]
    rows["outside and detected: abstains"] = _rate(outside, lambda p: p[1].verdict not in NAMES)
    pairs = [(t, a) for t, a in both if t.hidden is Hidden.PAIR and t.d >= 10.0]
    rows["pairs, both d >= 10: both right"] = _rate(pairs, _both)
    rows["pairs, both d >= 10: a wrong name"] = _rate(pairs, _wrong)
    group = [(t, a) for t, a in both if t.hidden is Hidden.CONFUSABLE and a.verdict != "nothing"]
    rows["confusable and detected: truth among the causes"] = _rate(group, _holds)
    return Marks(
        {name: rate for name, rate in rows.items() if rate.of},
        Counter((t.causes[0].label, _said(a)) for t, a in single if not _exact((t, a))),
        _reliability(named),
        _coverage(single),
        _seconds(both),
    )


def _rate(cases: Sequence[Case], hit: Callable[[Case], bool]) -> Rate:
    return Rate(sum(hit(case) for case in cases), len(cases))


def _firm(answer: Answer) -> bool:
    return answer.verdict in NAMES and any(answer.firm or [True])


def _exact(pair: tuple[Truth, Answer]) -> bool:
    truth, answer = pair
    return answer.verdict == "named" and list(answer.causes) == [truth.causes[0].label]


def _both(pair: tuple[Truth, Answer]) -> bool:
    truth, answer = pair
    return answer.verdict == "several" and set(answer.causes) == {c.label for c in truth.causes}


def _wrong(pair: tuple[Truth, Answer]) -> bool:
    truth, answer = pair
    return answer.verdict in NAMES and bool(set(answer.causes) - {c.label for c in truth.causes})


def _holds(pair: tuple[Truth, Answer]) -> bool:
    return pair[0].causes[0].label in pair[1].causes


def _said(answer: Answer) -> str:
    names = " + ".join(answer.causes) if answer.verdict in {*NAMES, "ambiguous"} else ""
    return f"{answer.verdict}: {names}" if names else answer.verdict


def _reliability(named: Sequence[tuple[Truth, Answer]]) -> dict[str, Rate]:
    found = {}
    for low, high in ((0.0, 0.5), (0.5, 0.9), (0.9, 0.99), (0.99, 1.01)):
        some = [pair for pair in named if low <= pair[1].probability < high]
        if some:
            found[f"{low:g} to {min(high, 1.0):g}"] = _rate(some, _exact)
    return found


def _coverage(single: Sequence[tuple[Truth, Answer]]) -> Rate:
    inside = []
    for truth, answer in filter(_exact, single):
        for name, departure in truth.causes[0].departures.items():
            for said, (_, low, high, nominal) in (answer.sizes or {}).items():
                if said.split(":")[-1] == name.split(":")[-1]:
                    inside.append(low <= nominal + departure <= high)
    return Rate(sum(inside), len(inside))


def _seconds(both: Sequence[tuple[Truth, Answer]]) -> dict[str, float]:
    groups: dict[str, list[float]] = {}
    for truth, answer in both:
        groups.setdefault(truth.hidden.value, []).append(answer.seconds)
    return {name: sorted(times)[len(times) // 2] for name, times in groups.items()}
