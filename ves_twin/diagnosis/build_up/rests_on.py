"""rests_on: the other proved causes without which a proved one would hardly be there."""

from __future__ import annotations

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.proof import Proof

HALF = 0.5
"""Share of its size below which a cause would hardly be there: half, by no measured set."""


def rests_on(proof: Proof, trial: int) -> tuple[str, ...]:
    """Labels of the causes without one of which a proved trial's size is less than half.

    Each is taken out alone, and all others are fitted anew. Where a motor of 1.46 times the torque
    stood for a pendulum of two thirds of its mass, the wheel that the motor drives had to be a
    third heavier as well: without the motor's gain it is as heavy as the model's.

    Args:
        proof: what is proved.
        trial: one of it.
    """
    bench, kept = proof.bench, list(proof.proved)
    regression, whitening = bench.regression, bench.fit.whitening

    def size(there: list[int]) -> FloatArray:
        return regression.solve(there, whitening).shares[regression.places(there)[trial]]

    whole, found = size(kept), []
    for other in kept:
        if other == trial:
            continue
        left = size([n for n in kept if n != other])
        if left @ whole < HALF * (whole @ whole):
            found.append(regression.trials[other].cause.label)
    return tuple(found)
