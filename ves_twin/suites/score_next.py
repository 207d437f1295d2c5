"""score_next: what the next experiment of ambiguous cases was worth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.suites.answers import Answer
from ves_twin.suites.judgement import Judgement, judge
from ves_twin.suites.rate import Rate
from ves_twin.suites.truth import Truth


@dataclass(frozen=True)
class NextScores:
    """How next experiments did.

    Attributes:
        rows: what is counted -> rate.
        points: predicted and realised separation of the rivals, chi^2 (n, 2).
    """

    rows: Mapping[str, Rate]
    points: FloatArray

    @property
    def correlation(self) -> float:
        """Of the logarithms of predicted and realised separation."""
        logs = np.log(np.maximum(self.points, 1.0))
        if len(logs) < 3 or np.any(np.ptp(logs, axis=0) == 0.0):
            return float("nan")
        return float(np.corrcoef(logs.T)[0, 1])


def score_next(
    truths: Sequence[Truth],
    first: Mapping[str, Answer],
    after: Mapping[str, Mapping[str, Answer]],
    played: Mapping[str, Mapping[str, str]],
) -> NextScores:
    """Count, of cases with one hidden cause that were ambiguous at first.

    Args:
        truths: of the suite.
        first: answers of the first recordings.
        after: choice -> answers of both recordings together.
        played: choice -> case -> programme.
    """
    rows: dict[str, Rate] = {}
    points = []
    hidden = {t.case: t.causes[0].label for t in truths if len(t.causes) == 1 and not t.aliases}
    ambiguous = [case for case in hidden if case in first and first[case].verdict == "ambiguous"]
    holds = [case for case in ambiguous if hidden[case] in first[case].causes]
    rows["ambiguous: truth among the causes"] = Rate(len(holds), len(ambiguous))
    for choice, answers in after.items():
        cases = [case for case in holds if case in answers]
        right = [case for case in cases if _names(answers[case], hidden[case])]
        wrong = [
            case
            for case in cases
            if answers[case].verdict == "named" and not _names(answers[case], hidden[case])
        ]
        rows[f"next experiment, {choice}: resolved"] = Rate(len(right), len(cases))
        rows[f"next experiment, {choice}: a wrong name"] = Rate(len(wrong), len(cases))
        for case in cases:
            realised = _realised(first[case], answers[case], hidden[case])
            predicted = (first[case].programmes or {})[played[choice][case]]
            if realised is not None:
                points.append((predicted, realised))
    return NextScores(rows, np.array(points).reshape(-1, 2))


def _names(answer: Answer, label: str) -> bool:
    return judge(answer, {label}, outside=False) is Judgement.RIGHT


def _realised(first: Answer, after: Answer, label: str) -> float | None:
    """chi^2 that the nearest of the first rivals leaves more than the true cause."""
    behind = after.behind or {}
    if label not in behind:
        return None
    others = [behind[c] for c in first.causes if c != label and c in behind]
    return max(min(others) - behind[label], 0.0) if others else None
