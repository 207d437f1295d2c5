"""out_of_step_sentence, shorter: rigs in order that leave so much that none is in order for it."""

from __future__ import annotations

from ves_twin.core.quantity import digits
from ves_twin.diagnosis.verdict.verdict import Verdict


def out_of_step_sentence(verdict: Verdict) -> str:
    """What machines in order leave here, and what that means; empty where they come to noise."""
    most = verdict.statistics.misfit_in_order
    if most is None:
        return ""
    instead = (
        "So efforts are compared in place of motions: of each joint what its measured motion asks"
        " for beyond the model and its commands (.missing)."
        if verdict.basis.by_motion
        else "So this record was judged by noise alone."
    )
    return (
        "Simulations cannot be compared here: those of machines in order, within the declared"
        f" tolerances, differ by up to {digits(most)} times the noise. {instead}"
    )


def shorter(verdict: Verdict) -> str:
    """What to do about it; empty where they come to noise, or the motion told."""
    if verdict.statistics.misfit_in_order is None or (verdict.basis.by_motion and verdict.proved):
        return ""
    if verdict.basis.pieces:
        return (
            "Take shorter pieces (drive.horizon in the machine's file), or declare tolerances as"
            " narrow as you know the numbers, and diagnose again."
        )
    return (
        "Where the log tells every joint's start, simulate pieces of it that begin from what was"
        " measured (drive.horizon in the machine's file, of 100 rows or more); else record a slower"
        " motion, and diagnose again."
    )
