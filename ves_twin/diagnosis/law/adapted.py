"""adapted: evidence with its noise as a fit leaves it."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.diagnosis.fit.refine import Fit, bare_residual
from ves_twin.diagnosis.record.evidence import Evidence


def adapted(evidence: Evidence, fit: Fit) -> Evidence:
    """Level and colour of each channel's noise from what a fit leaves above a third of the band."""
    own = evidence.whitening
    plain = replace(own, colour=0.0 * own.colour, level=0.0 * own.level + 1.0)
    return replace(evidence, whitening=plain.adapted(plain.apply(bare_residual(evidence, fit))))
