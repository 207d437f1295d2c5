"""band_of_form: the band of a closed form, which may only come near what it stands for."""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag
from scipy.stats import norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate, Closed, Table
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.screen import columns_about, knots
from ves_twin.diagnosis.law.smoothness import best_of, projected
from ves_twin.diagnosis.record.evidence import Evidence


def band_of_form(
    evidence: Evidence, best: LawFit, at: FloatArray, probability: float
) -> FloatArray:
    """Ends (2, n) of the band of a form plus a smooth departure from it.

    With J the form's columns and Z those of a table beside it, numbers a and departures c have the
    precision [J Z]' P [J Z] + diag(1 / sd^2, (s^2 K)^-1), commissioning errors marginalised by P;
    s and the length of K are those of largest evidence, the form's numbers marginalised too. Of a
    form that is the truth s is next to nothing. The form itself lies within.

    Args:
        evidence: with the noise that the form leaves.
        best: its fit.
        at: places of the band (n,).
        probability: that the band holds.
    """
    form = best.candidate
    if not isinstance(form, Closed):
        raise TypeError("a band of a form that is none")
    variable = form.of[0]
    table = Table(form.place, form.of, knots(variable, (float(at[0]), float(at[-1]))))
    count = best.count
    own, others = best.jacobian[:, :count] * form.sd, best.jacobian[:, count:]
    beside = columns_about(evidence, table, best)
    z = best.fit.residual + others @ best.point[count:]
    gram, slope = projected(np.hstack([own, beside]), others, z, best.temper)
    off = (form.mean - best.numbers) / form.sd
    slope[:count] += off  # the form's own prior, of unit sd in these units
    first = gram[:count, :count] + np.eye(count)
    cross = np.linalg.solve(first, gram[:count, count:])
    alone = gram[count:, count:] - gram[:count, count:].T @ cross
    smooth = best_of(alone, slope[count:] - cross.T @ slope[:count], table)
    prior = np.linalg.inv(smooth.size**2 * table.kernels[smooth.length])
    covariance = np.linalg.inv(gram + block_diag(np.eye(count), prior))
    hats = np.stack([np.interp(at, table.knots, row) for row in np.eye(len(table.knots))])
    turn = np.hstack([_slopes(form, best.numbers, at) * form.sd, hats.T])
    law = form.law(best.numbers).at(at)
    centre = law + turn @ (covariance @ slope)
    sd = np.sqrt(np.maximum(np.einsum("nk,kl,nl->n", turn, covariance, turn), 0.0))
    reach = float(norm.isf(0.5 * (1.0 - probability))) * sd
    return np.stack([np.minimum(centre - reach, law), np.maximum(centre + reach, law)])


def _slopes(form: Candidate, numbers: FloatArray, at: FloatArray) -> FloatArray:
    """Change of a law at places (n, k) for a unit of each of its numbers."""
    here = form.law(numbers).at(at)
    pairs = zip(np.diag(form.steps), form.steps, strict=True)
    return np.stack([(form.law(numbers + row).at(at) - here) / step for row, step in pairs], axis=1)
