"""tolerance_scale: how far rigs really are from nominal, in declared commissioning sd."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, norm

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.signature_library import (
    SignatureLibrary,
    bank_key,
    read_arrays,
    still_predicts,
    write_arrays,
)
from ves_twin.diagnosis.fit.refine import bare_residual, refine, residual_about
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

VISIBLE = 3.0
"""A direction counts if one declared sd of it shows with this variance in noise units."""

UNKNOWN_SCALE = 2.5
"""Scale that is assumed without commissioning recordings (notes on the remedy: kappa = 9.6)."""

FEWEST = 5
"""Commissioning rigs from which the scale is trusted."""

ALPHA = 0.01
"""Probability that any of the tolerances of a rig in order passes kappa."""


def check_commissioned(count: int, fewest: int = FEWEST) -> None:
    """Refuse rigs in order that are too few to tell the tolerances.

    Raises:
        InvalidInputError: some, but fewer.
    """
    if 0 < count < fewest:
        expected = f"none, or at least {fewest}: fewer do not tell the tolerances"
        raise InvalidInputError("commissioned rigs", count, expected)


def tolerance_scale(rigs: Sequence[tuple[Runs, SingleArray]]) -> float:
    """Scale s of the nuisances' spread, from recordings of rigs that are in order.

    With N'N = V L V' and c = V' N' z, c_i^2 / L_i has mean 1 + s^2 L_i; s makes the median of
    c_i^2 / (L_i (1 + s^2 L_i)) that of chi^2 with one degree of freedom. The median stands what
    likelihood does not: a few directions in which the model itself is wrong.

    Args:
        rigs: runs and measured channels of independent rigs or re-mountings.
    """
    ratios = [_directions(runs, measured) for runs, measured in rigs]
    squares = np.concatenate([a for a, _ in ratios])
    weights = np.concatenate([b for _, b in ratios])
    goal = float(chi2.median(1))

    def excess(scale: float) -> float:
        return float(np.median(squares / (1.0 + scale**2 * weights))) - goal

    if excess(1e-3) < 0.0:
        return 0.0
    return float(brentq(excess, 1e-3, 1e3))


def cached_scale(rigs: Sequence[tuple[Runs, SingleArray]], folder: Path | None) -> float:
    """The scale from a file, computed and written where none holds: each rig costs a fit.

    It holds while the forward predicts what it did, as a bank does.

    Raises:
        FileAccessError: the folder cannot be written.
    """
    if folder is None:
        return tolerance_scale(rigs)
    content = "".join(bank_key(runs, measured.tobytes()) for runs, measured in rigs)
    path = folder / f"scale-{bank_key(rigs[0][0], content.encode())}.npz"
    kept = read_arrays(path)
    if kept is not None:
        scale, told = float(kept["scale"]), kept["predictions"]
        parts = np.split(told, np.cumsum([measured.size for _, measured in rigs])[:-1])
        if all(
            still_predicts(runs, part.reshape(measured.shape))
            for (runs, measured), part in zip(rigs, parts, strict=True)
        ):
            return scale
    scale = tolerance_scale(rigs)
    told = np.concatenate([runs.one(runs.origin).ravel() for runs, _ in rigs])
    write_arrays(path, scale=np.array(scale), predictions=told)
    return scale


def _directions(runs: Runs, measured: SingleArray) -> tuple[FloatArray, FloatArray]:
    base = linearise(runs, runs.origin)
    whitening = whitening_declared(runs)
    evidence = Evidence(runs, measured, whitening)
    fit = refine(evidence, (), runs.origin, base)
    own = whitening.adapted(whitening.apply(bare_residual(evidence, fit)))
    z = residual_about(Evidence(runs, measured, own), fit, base)
    columns = own.apply(base.columns[:-1]).T
    weights, vectors = np.linalg.eigh(inner(columns, columns))
    kept = weights > VISIBLE
    along = (vectors.T @ (columns.T @ z))[kept] ** 2 / weights[kept]
    return along, weights[kept]


def naming_limit(bank: SignatureLibrary, scale: float | None) -> float:
    """kappa: declared sd beyond which a departure is called a fault, and no commissioning error.

    kappa = s z(1 - alpha / 2 m), m nuisances.

    Args:
        bank: whose nuisances are counted.
        scale: of the tolerances, at least 1 is taken; UNKNOWN_SCALE if None.
    """
    count = max(len(bank.base.runs.nuisances), 1)
    factor = UNKNOWN_SCALE if scale is None else max(scale, 1.0)
    return factor * float(norm.isf(ALPHA / (2.0 * count)))
