"""score: answers against the truth: counts, Wilson intervals, confusions, by size in sigma."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.suites.answers import Answer
from ves_twin.suites.judgement import NAMES, Judgement, judge
from ves_twin.suites.rate import Rate
from ves_twin.suites.score_many import score_many
from ves_twin.suites.seal import unseal
from ves_twin.suites.suite import load_suite
from ves_twin.suites.truth import Hidden, Truth

Pair = tuple[Truth, Answer]

CLEAR = 10.0
"""Size in sigma from which a cause, or both of two, should be found."""

BINS = (0.0, 6.0, 10.0, 20.0, float("inf"))
"""Sizes in sigma that are counted apart."""


@dataclass(frozen=True)
class Scores:
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


def score(
    truths: Sequence[Truth],
    answers: Mapping[str, Answer],
    other: Mapping[str, Answer] | None = None,
) -> Scores:
    """Score anybody's answers; a case without one is not counted.

    Args:
        truths: of the suite.
        answers: case -> answer.
        other: answers from other material, to say how many of their firm names stay.

    Raises:
        InvalidInputError: no case is answered.
    """
    both = [(t, answers[t.case]) for t in truths if t.case in answers]
    if not both:
        raise InvalidInputError("answers", f"cases {sorted(answers)[:3]}", "cases of the suite")
    single = [(t, a) for t, a in both if t.hidden is Hidden.SINGLE]
    named = [pair for pair in single if pair[1].verdict in NAMES]
    rows = _rows_of_none(both) | _rows_of_single(single, named) | _rows_of_others(both)
    rows |= score_many(both)
    firm = [(t, a) for t, a in single if other and _right_firm((t, other.get(t.case, _NONE)))]
    rows["single: firm names of the other answers that stay"] = Rate.over(firm, _right_firm)
    repaired = [a for t, a in both if t.repaired and a.verdict == "named" and a.passed is not None]
    rows["held-out without the effect: the gate refuses"] = Rate.over(
        repaired, lambda a: not a.passed
    )
    return Scores(
        {name: rate for name, rate in rows.items() if rate.of},
        Counter((t.causes[0].label, _said(a)) for t, a in single if not _right((t, a))),
        _reliability(named),
        _coverage(single),
        _seconds(both),
    )


_NONE = Answer("none")


def _rows_of_none(both: Sequence[Pair]) -> dict[str, Rate]:
    none = [a for t, a in both if t.hidden is Hidden.NONE]
    return {
        "nothing hidden: nothing said": Rate.over(none, lambda a: a.verdict == "nothing"),
        "nothing hidden: a false name": Rate.over(none, lambda a: a.verdict in NAMES),
        "nothing hidden: firm false name": Rate.over(none, _firm),
        "nothing hidden: false unknown": Rate.over(none, lambda a: a.verdict == "unknown"),
    }


def _rows_of_single(single: Sequence[Pair], named: Sequence[Pair]) -> dict[str, Rate]:
    rows = {}
    for low, high in pairwise(BINS):
        some = [pair for pair in single if low <= pair[0].d < high]
        rows[f"single, d {low:g} to {high:g}: exact"] = Rate.over(some, _right)
    clear = [pair for pair in single if pair[0].d >= CLEAR]
    rows[f"single, d >= {CLEAR:g}: exact"] = Rate.over(clear, _right)
    rows[f"single, d >= {CLEAR:g}: exact and firm"] = Rate.over(clear, _right_firm)
    rows["single: a wrong name"] = Rate.over(single, _wrong)
    rows["single: right if named"] = Rate.over(named, _right)
    seen = [pair for pair in single if pair[1].verdict in {*NAMES, "ambiguous"}]
    rows["single and detected: truth among the causes"] = Rate.over(seen, _holds)
    return rows


def _rows_of_others(both: Sequence[Pair]) -> dict[str, Rate]:
    outside = [(t, a) for t, a in both if t.hidden is Hidden.OUTSIDE and a.verdict != "nothing"]
    kinds = [pair for pair in outside if pair[0].outside]
    left_out = [pair for pair in outside if not pair[0].outside]
    pairs = [(t, a) for t, a in both if t.hidden is Hidden.PAIR and t.d >= CLEAR]
    edited = [(t, a) for t, a in both if t.hidden is Hidden.EDITED and a.verdict != "nothing"]
    group = [(t, a) for t, a in both if t.hidden is Hidden.CONFUSABLE and a.verdict != "nothing"]
    return {
        "a kind that the library lacks, detected: abstains": Rate.over(kinds, _abstains),
        "a cause left out, detected: abstains": Rate.over(left_out, _abstains),
        "a cause left out, detected: a name beyond its aliases": Rate.over(left_out, _beyond),
        f"pairs, both d >= {CLEAR:g}: both right": Rate.over(pairs, _right),
        f"pairs, both d >= {CLEAR:g}: a wrong name": Rate.over(pairs, _wrong),
        "confusable and detected: truth among the causes": Rate.over(group, _holds),
        "a cause by an edit, detected: exact": Rate.over(edited, _right),
        "a cause by an edit, detected: a wrong name": Rate.over(edited, _wrong),
        "a cause by an edit: 90 % intervals that hold its size": _coverage(edited),
    }


def _abstains(pair: Pair) -> bool:
    return pair[1].verdict not in NAMES


def _beyond(pair: Pair) -> bool:
    """Whether it names what the cause cannot be taken for, told before the answer."""
    truth, answer = pair
    aliases = [set(labels) for labels in truth.aliases]
    return answer.verdict in NAMES and set(answer.causes) not in aliases


def _right_firm(pair: Pair) -> bool:
    return _right(pair) and all(pair[1].firm)


def _firm(answer: Answer) -> bool:
    return answer.verdict in NAMES and any(answer.firm or [True])


def _right(pair: Pair) -> bool:
    truth, answer = pair
    return judge(answer, truth.labels, outside=False) is Judgement.RIGHT


def _wrong(pair: Pair) -> bool:
    truth, answer = pair
    judged = judge(answer, truth.labels, outside=False)
    return answer.verdict in NAMES and judged is Judgement.WRONG


def _holds(pair: Pair) -> bool:
    return pair[0].causes[0].label in pair[1].causes


def _said(answer: Answer) -> str:
    names = " + ".join(answer.causes) if answer.verdict in {*NAMES, "ambiguous"} else ""
    return f"{answer.verdict}: {names}" if names else answer.verdict


def _reliability(named: Sequence[Pair]) -> dict[str, Rate]:
    found = {}
    for low, high in ((0.0, 0.5), (0.5, 0.9), (0.9, 0.99), (0.99, 1.01)):
        some = [pair for pair in named if low <= pair[1].probability < high]
        if some:
            found[f"{low:g} to {min(high, 1.0):g}"] = Rate.over(some, _right)
    return found


def _coverage(single: Sequence[Pair]) -> Rate:
    inside = []
    for truth, answer in filter(_right, single):
        for name, departure in truth.causes[0].departures.items():
            for said, (_, low, high, nominal) in (answer.sizes or {}).items():
                if said.split(":")[-1] == name.split(":")[-1]:
                    inside.append(low <= nominal + departure <= high)
    return Rate(sum(inside), len(inside))


def _seconds(both: Sequence[Pair]) -> dict[str, float]:
    groups: dict[str, list[float]] = {}
    for truth, answer in both:
        groups.setdefault(truth.hidden.value, []).append(answer.seconds)
    return {name: sorted(times)[len(times) // 2] for name, times in groups.items()}
