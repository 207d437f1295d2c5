"""claimed_laws: the law that a verdict claims, as a machine's file has it."""

from __future__ import annotations

from ves_twin.diagnosis.law.finding import SOURCE
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.law import LawKind, LawShape
from ves_twin.effects.law_table import LawTable


def claimed_laws(verdict: Verdict) -> tuple[LawTable, ...]:
    """The claimed law; () where there is none."""
    found = verdict.law
    if found is None or not found.claimed:
        return ()
    law = LawTable(
        place=found.place,
        kind=LawKind(found.kind),
        shape=LawShape(found.shape),
        of=found.of,
        knots=found.knots,
        values=found.values,
        form=found.form,
        seen=found.seen,
        source=SOURCE,
    )
    return (law,)
