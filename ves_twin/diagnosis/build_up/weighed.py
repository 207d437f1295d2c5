"""weighed: a proof with channels by themselves, or together where that predicts better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.judges import Judges
from ves_twin.diagnosis.build_up.offer import left_of
from ves_twin.diagnosis.build_up.proof import Proof, prove
from ves_twin.diagnosis.build_up.regression import Half, Regression

CLEARLY = 10.0
"""Nats by which channels together must predict better than each by itself. Chosen on a double
pendulum's link (69 and 201) and a cylinder's speeds (2, either way), of which a delay was told at
half its size."""


def weighed(regression: Regression, held: Half, chosen: Sequence[int], more: int = 0) -> Proof:
    """The proof of a choice, by channels together where what is proved CLEARLY predicts better so.

    Of plain errors the fitted half does not tell it. What several missed causes leave goes along in
    many channels, and weighed together it pulls sizes (a six-axis arm, all frictions but one were
    lost); where little else is missed two torques tell more together than apart (a double
    pendulum's link). Poses at rest, and a single channel, have one weight.

    Args:
        regression: of the fitted half.
        held: the held-out half.
        chosen: trials that are put to proof.
        more: trials that were put to proof before, which count for the rate.
    """
    moving = not all(programme.poses for programme in held.runs.programmes)
    ways = (True, False) if moving and len(held.runs.columns) > 1 else (True,)
    sound = [n for n in chosen if n not in held.columns.failed(chosen)]
    proofs = [
        prove(regression, held, chosen, more, Judges.of(regression, sound, apart=apart))
        for apart in ways
    ]
    if len(proofs) == 1:
        return proofs[0]
    apart, together = left_of(held, regression.quietest, [_left(proof) for proof in proofs])
    return proofs[1] if together < apart - CLEARLY else proofs[0]


def _left(proof: Proof) -> FloatArray:
    """What is left of held-out rows (rows, c), sizes by plain squares of that weight."""
    bench, names = proof.bench, proof.proved
    fit = bench.regression.fit(names, memory=False, apart=proof.judges.apart)
    return replace(bench, fit=fit, memory=False).residual(names)
