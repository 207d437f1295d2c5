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
        "compared are the efforts that the measured motion lacks, joint by joint (.missing)"
        if verdict.basis.by_motion
        else "this record was judged by noise alone"
    )
    return (
        "Simulations fall out of step here, or tolerances are wide for so little noise: machines in"
        " order, simulated with errors within the declared tolerances, leave up to"
        f" {digits(most)} sigma in a band or stretch of time. That tells nothing, so {instead}."
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
