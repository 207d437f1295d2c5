"""Scorecard: every claim of the thesis with its verdict, and the score without circularity."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from pydantic import JsonValue

from ves_twin.core.errors import VesTwinError, one_line
from ves_twin.thesis.claim import Claim, Kind
from ves_twin.thesis.context import Context, Models
from ves_twin.thesis.evaluation import (
    Answer,
    Evaluation,
    Evaluator,
    NotBuilt,
    NotRun,
    NotTestable,
)
from ves_twin.thesis.left_out import FOLDER, PlantWithout, plant_without
from ves_twin.thesis.row import Row
from ves_twin.thesis.store import Store, code_hash
from ves_twin.thesis.verdict import Verdict

Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and the claim that comes next."""


@dataclass(frozen=True)
class Scorecard:
    """Rows in the order of the thesis, and in which world they were computed."""

    rows: tuple[Row, ...]
    plant: str
    plant_hash: str
    quick: bool
    models: Models

    @property
    def score(self) -> dict[str, int]:
        """Verdicts of the rows that count: neither inputs nor used in calibration."""
        return _count(row for row in self.rows if row.claim.counts)

    @property
    def inputs(self) -> dict[str, int]:
        """Verdicts of the inputs: whether the twin has them as given."""
        return _count(row for row in self.rows if row.claim.kind is Kind.INPUT)

    @property
    def calibrated(self) -> tuple[Row, ...]:
        """Rows that the twin was tuned on."""
        return tuple(row for row in self.rows if row.claim.calibrated_on)

    def to_dict(self) -> dict[str, JsonValue]:
        """Plain values for JSON."""
        return {
            "plant": self.plant,
            "plant_hash": self.plant_hash,
            "code": code_hash(),
            "quick": self.quick,
            "models": self.models.value,
            "score": dict(self.score),
            "inputs": dict(self.inputs),
            "rows": [row.to_dict() for row in self.rows],
        }


def score_claims(
    claims: Iterable[Claim],
    answers: Mapping[str, Answer],
    context: Context,
    store: Store | None = None,
    progress: Progress = lambda share, what: None,
    without: PlantWithout = plant_without,
) -> Scorecard:
    """Evaluate claims and put them into a scorecard.

    Args:
        claims: which, in the order of the rows.
        answers: claim id -> evaluator, or why there is none.
        context: the world; simulations are shared between the claims.
        store: where evaluations are kept between calls; None computes all of them.
        progress: called before each claim.
        without: the rig calibrated without a claim, for its leave-one-out prediction.
    """
    chosen = list(claims)
    rows = []
    for number, claim in enumerate(chosen):
        progress(number / len(chosen), claim.id)
        answer, predicted = answers[claim.id], None
        if isinstance(answer, NotBuilt | NotTestable):
            rows.append(Row(claim, answer))
            continue
        found = _evaluate(answer, claim, context, store)
        other = without(claim.id) if claim.calibrated_on else None
        if other is not None:
            file = f"models/{FOLDER}/{claim.id}.toml"
            there = replace(context, plant=other, plant_name=file, _kept={})
            other_found = _evaluate(answer, claim, there, store)
            predicted = other_found if isinstance(other_found, Evaluation) else None
        rows.append(Row(claim, found, predicted))
    progress(1.0, "done")
    return Scorecard(
        tuple(rows), context.plant.name, context.plant.hash, context.quick, context.models
    )


def _evaluate(
    evaluator: Evaluator, claim: Claim, context: Context, store: Store | None
) -> Evaluation | NotRun:
    found: Evaluation | NotRun | None = store.get(context, claim.id) if store else None
    if found is None:
        try:
            found = evaluator(context, claim)
        except VesTwinError as error:
            found = Evaluation(holds=False, note=f"could not be computed: {one_line(error)}")
        if store and isinstance(found, Evaluation):
            store.put(context, claim.id, found)
    return found


def _count(rows: Iterable[Row]) -> dict[str, int]:
    counts = {verdict.value: 0 for verdict in Verdict}
    for row in rows:
        counts[row.verdict.value] += 1
    return counts
