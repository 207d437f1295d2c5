"""Row: a claim, what the twin gives for it, and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pydantic import JsonValue

from ves_twin.thesis.claim import Claim
from ves_twin.thesis.evaluation import Evaluation, Found, NotBuilt
from ves_twin.thesis.verdict import Verdict, judge

NOT_COMPUTED = "leave-one-out not computed"


@dataclass(frozen=True)
class Row:
    """One line of the scorecard.

    Attributes:
        claim: what the thesis says.
        found: what the twin gives, or why it gives nothing.
        predicted: what a rig calibrated without this claim gives; None where that was not
            computed, or the claim was not used in calibration.
    """

    claim: Claim
    found: Found
    predicted: Evaluation | None = None

    @property
    def verdict(self) -> Verdict:
        """How the claim came out."""
        return judge(self.claim, self.found)

    @property
    def values(self) -> tuple[float, ...]:
        """The twin's values in the claim's unit."""
        return self.found.values if isinstance(self.found, Evaluation) else ()

    @property
    def note(self) -> str:
        """What was measured, what is needed, or why nothing can be."""
        if isinstance(self.found, NotBuilt):
            return f"needs {self.found.needs}"
        return self.found.note if isinstance(self.found, Evaluation) else self.found.reason

    @property
    def runs(self) -> tuple[str, ...]:
        """Commands of the simulations behind the values."""
        return self.found.runs if isinstance(self.found, Evaluation) else ()

    @property
    def command(self) -> str:
        """The command that computes this row again."""
        return f"ves-twin reproduce {self.claim.id}"

    def to_dict(self) -> dict[str, JsonValue]:
        """Plain values for JSON."""
        claim = self.claim
        asked = [t.words(claim.unit) if t else None for t in (claim.tolerance, claim.in_kind)]
        return {
            "id": claim.id,
            "where": claim.where,
            "chapter": claim.chapter,
            "quantity": claim.quantity,
            "kind": claim.kind.value,
            "printed": claim.printed,
            "thesis": _plain(claim.value),
            "corrected": _plain(claim.corrected),
            "unit": claim.unit,
            "tolerance": asked[0],
            "in_kind": asked[1],
            "twin": _plain(self.values),
            "verdict": self.verdict.value,
            "reason": self.note,
            "command": self.command,
            "runs": list(self.runs),
            "figure": claim.figure or None,
            "errata": list(claim.errata),
            "calibrated_on": claim.calibrated_on or None,
            "counts": claim.counts,
            "leave_one_out": self._left_out(),
        }

    def _left_out(self) -> JsonValue:
        if not self.claim.calibrated_on:
            return None
        if self.predicted is None:
            return NOT_COMPUTED
        verdict = judge(self.claim, self.predicted).value
        return {"twin": _plain(self.predicted.values), "verdict": verdict}


def _plain(values: tuple[float, ...]) -> JsonValue:
    return [value if math.isfinite(value) else None for value in values]
