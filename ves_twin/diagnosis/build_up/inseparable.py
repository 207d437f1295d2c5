"""inseparable: extensions of which recordings know only a combination."""

from __future__ import annotations

import numpy as np

from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.result import Inseparable

WORSE = 10.0
"""Times that one combination is known worse than the best from which it is said."""

TAKES_PART = 0.3
"""Weight in a combination from which a name takes part in it."""


def inseparable(proof: Proof, others: dict[int, list[int]]) -> tuple[Inseparable, ...]:
    """Combinations of proved trials and of what stands in for them, by singular values.

    Columns are whitened by the discrepancy, cleared of what commissioning errors can explain, and
    of unit length: a small singular value is a combination that leaves the record as it is.

    Args:
        proof: what is proved.
        others: stand-ins of each proved trial.
    """
    regression = proof.bench.regression
    trials = list(dict.fromkeys([*proof.proved, *(k for ks in others.values() for k in ks)]))
    if len(trials) < 2:
        return ()
    whitening = proof.bench.fit.whitening
    empty = regression.solve([], whitening)
    gains = regression.gains(empty, trials)
    gram = gains.gram
    unit = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-30))
    values, vectors = np.linalg.eigh(gram * np.outer(unit, unit))
    owner = np.concatenate([np.full(len(gains.where[n]), n) for n in trials])
    found: dict[frozenset[str], Inseparable] = {}  # of the same names the worst
    for value, vector in zip(values, vectors.T, strict=True):
        ratio = float(np.sqrt(values[-1] / max(float(value), 1e-12)))
        if ratio < WORSE:
            break
        names = dict.fromkeys(
            regression.trials[int(n)].cause.label for n in owner[np.abs(vector) > TAKES_PART]
        )
        if len(names) > 1:
            found.setdefault(frozenset(names), Inseparable(tuple(names), ratio))
    return tuple(found.values())
