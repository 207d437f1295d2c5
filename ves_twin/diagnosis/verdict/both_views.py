"""both_views: one verdict of two, with tolerances as declared and as rigs in order show them."""

from __future__ import annotations

from ves_twin.diagnosis.verdict.verdict import Kind, Verdict


def both_views(declared: Verdict, measured: Verdict) -> Verdict:
    """Which of the two is said.

    A name that is firm with the tolerances as measured holds; so does one that only the tighter
    view is sharp enough to see, for kappa is that of the measured tolerances in both. Without a
    firm name a record within the measured tolerances is in order, unless the tighter view can say
    which single parameter is off; and what the wider view cannot explain is unknown.

    Args:
        declared: with tolerances as declared; it saw something.
        measured: with tolerances widened to what was measured.
    """
    if is_firm(measured):
        return measured
    if is_firm(declared) and not _firm_rival(declared, measured):
        return declared
    if measured.verdict is Kind.NOTHING and declared.verdict is Kind.NAMED:
        return declared
    return measured


def is_firm(verdict: Verdict) -> bool:
    """Whether every cause that it names is a fault for sure, and it names some for good."""
    return verdict.verdict.names_a_plant and all(cause.firm for cause in verdict.causes)


def _firm_rival(declared: Verdict, measured: Verdict) -> bool:
    """Whether the wider view explains the record by something else."""
    if not measured.verdict.names_causes:
        return False
    names = {(c.effect, c.target) for c in declared.causes}
    return not names <= {(c.effect, c.target) for c in measured.causes}
