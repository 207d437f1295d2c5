"""LeanEvidence: evidence of a machine whose runs are dear, with what a search has learnt of it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.law.candidate import Candidate, Closed, Table
from ves_twin.diagnosis.law.forms import TONE
from ves_twin.diagnosis.law.sizes import Sizes
from ves_twin.diagnosis.record.evidence import Evidence


class Hats:
    """What laws of one variable at one place change in the channels, knot by knot."""

    def __init__(self) -> None:
        self._kept: dict[tuple[str, str], tuple[FloatArray, SingleArray]] = {}

    def changes(self, candidate: Candidate, numbers: FloatArray) -> SingleArray | None:
        """Change (k, rows, c) for a unit of each number of a law, at given numbers.

        By the changes for hats, sum_k dg/dn (x_k) change_k; None where those are not known, or
        where the law bends more than they tell.
        """
        kept = self._kept.get(_key(candidate))
        if kept is None or not isinstance(candidate, Table | Closed | Sizes):
            return None
        knots, changes = kept
        if isinstance(candidate, Table) and len(candidate.knots) > len(knots):
            return None
        if isinstance(candidate, Closed) and TONE in candidate.forms:
            return None
        if isinstance(candidate, Sizes) and any(TONE in e.forms for e in candidate.entries):
            return None
        here = candidate.law(numbers).at(knots)
        pairs = zip(np.diag(candidate.steps), candidate.steps, strict=True)
        rows = [(candidate.law(numbers + row).at(knots) - here) / step for row, step in pairs]
        return np.asarray(np.tensordot(np.array(rows, np.float32), changes, axes=1))

    def keep(self, candidate: Candidate, changes: SingleArray) -> None:
        """Keep the changes for a unit of each number of a table, if there are no finer ones."""
        if isinstance(candidate, Table):
            before = self._kept.get(_key(candidate))
            if before is None or len(before[0]) < len(candidate.knots):
                self._kept[_key(candidate)] = np.array(candidate.knots), changes


@dataclass(frozen=True)
class LeanEvidence(Evidence):
    """For fits that run the plant for what they predict, and next to never for columns.

    Those of commissioning errors are the ones that a fit begins with; a law's are put together from
    those of hats. What is predicted, and so where a fit ends, is simulated with the law inside. For
    machines whose loops hold a motion whatever pushes, so that columns hardly turn.

    Attributes:
        hats: columns of laws.
    """

    hats: Hats = field(default_factory=Hats)


def _key(candidate: Candidate) -> tuple[str, str]:
    return candidate.place.name, ", ".join(v.name for v in candidate.of)
