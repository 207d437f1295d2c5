"""detectability: the size of an effect in sigma, after commissioning errors took what they can."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.fit.refine import ROUGH, refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.whitening import Whitening

STEPS = 6
"""Of a search at most: d within a hundredth is enough to sort cases."""


def detectability(
    local: Linearisation, whitening: Whitening, shift: FloatArray, rounds: int = 3
) -> float:
    """D of a departure: the root of the least chi^2 that commissioning errors alone leave of it.

    To a hundredth, from above: a search ends where it hardly falls any more.

    d^2 = min over nu of |W (f(shift) - f(nu))|^2 + sum (nu / sd)^2. For a linear model this is
    <s, s> of the marginalised signature.

    Args:
        local: nuisance columns at nominal.
        whitening: noise as declared.
        shift: departures of the effect alone (coordinates,).
        rounds: linearisations at most.
    """
    runs = local.runs
    evidence = Evidence(runs, runs.one(shift), whitening)
    # from nominal, and from where commissioning errors of that size themselves would be
    starts = (runs.origin, np.where(runs.sd > 0.0, shift, 0.0))
    different = {start.tobytes(): start for start in starts}
    fits = [
        refine(evidence, (), start, local, rounds, enough=ROUGH, steps=STEPS)
        for start in different.values()
    ]
    return float(np.sqrt(min(fit.chi2 for fit in fits)))
