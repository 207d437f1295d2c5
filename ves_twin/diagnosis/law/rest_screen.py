"""rest_screen: laws by what they make of model error, each with the error that it leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.screen import columns_about
from ves_twin.diagnosis.law.smoothness import best_of, projected
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.effects.law import WITHIN

ROUNDS = 3
"""Times that the size of each channel's model error is learnt anew beside a table."""

LEAST = 1e-4
"""Share of a channel's square that a table leaves at least."""


def rest_screen(
    evidence: Evidence, laws: Sequence[Candidate], about: LawFit, progress: Progress = silent
) -> list[Candidate]:
    """Laws by falling evidence beside a fit, the best width of each joint's play alone.

    The size v of model error in each channel is not known: that of largest evidence is taken, for
    no law and for each law. One that is most of one channel's rest then leads over one that is
    a part of a larger rest:
    log E = -sum(n log v) / 2 - (z' P z - b' (G + (s^2 K)^-1)^-1 b + log|I + s^2 K G|) / 2, under v.

    Args:
        evidence: what was measured, by plain squares.
        laws: with smooth priors.
        about: commissioning errors and causes, without a law.
        progress: told how far it is.
    """
    z = about.fit.residual + about.jacobian @ about.point
    found: dict[tuple[str, ...], tuple[float, Candidate]] = {}
    for n, law in enumerate(laws):
        progress(n / len(laws), "screening laws of what is left")
        columns = columns_about(evidence, law, about)
        if not np.any(columns):
            continue
        score = _score(columns, about.jacobian, z, law, evidence)
        name, play, _ = law.of[0].name.partition(WITHIN)
        family = law.place.name, name, play, *(v.name for v in law.of[1:])
        if family not in found or score > found[family][0]:
            found[family] = score, law
    return [law for _, law in sorted(found.values(), key=lambda one: -one[0])]


def _score(
    columns: FloatArray, others: FloatArray, z: FloatArray, family: Candidate, evidence: Evidence
) -> float:
    """Log evidence but for a constant [nats]."""
    width = evidence.whitening.mixing.shape[1]
    counted = evidence.whitening.freedom.reshape(-1, width)
    count = np.maximum(counted.sum(axis=0), 1.0)
    square, score = np.ones(width), -np.inf
    for _ in range(ROUNDS):
        unit = np.tile(np.sqrt(square), len(counted))
        law, errors, target = columns / unit[:, None], others / unit[:, None], z / unit
        gram, slope = projected(law, errors, target, 1.0)
        smooth = best_of(gram, slope, family)
        prior = np.linalg.inv(smooth.size**2 * family.kernels[smooth.length])
        numbers = np.linalg.solve(gram + prior, slope)
        left = target - law @ numbers
        inverse = errors.T @ errors + np.eye(errors.shape[1])
        pull = np.linalg.solve(inverse, errors.T @ target)
        none = float(target @ (target - errors @ pull))
        score = smooth.gain - 0.5 * none - 0.5 * float(count @ np.log(square))
        left = (left - errors @ np.linalg.solve(inverse, errors.T @ left)) * unit
        rest = np.square(left.reshape(-1, width)).sum(axis=0) / count
        square = np.maximum(rest, LEAST)
    return score
