"""refine: the most probable size of a cause, together with the nuisances, by the full forward."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.linearise import STEP_SD, Linearisation, renewed
from ves_twin.diagnosis.fit.probe import probe
from ves_twin.diagnosis.fit.search import (
    FARTHEST,
    ITERATIONS,
    RELATIVE_CONVERGENCE,
    CauseColumns,
    Point,
    Search,
)
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

NEAR = 0.3
"""Commissioning sd within which nuisance columns are taken to hold; absent parameters: 6 %."""

ROUGH = 0.01
"""Fall of chi^2, of all of it, that ends a search whose end nobody reads: it is gone on with where
the fit turns out to be near the best, or a share of chi^2 is all that is asked."""

TURNED = 4
"""Parameters of causes whose columns are kept from one search to the next: a search takes a few
steps, each of which turns columns along one direction. Seen on TX40: with a score of them 11.2 % of
the torque are left where they are kept, 9.1 % where they are computed anew."""

WORTH = 3e-4
"""Fall of chi^2, of all of it, below which another linearisation is not worth its runs."""


@dataclass(frozen=True)
class Fit:
    """The most probable point under one set of causes.

    chi^2 = |W (y - f(x) - delta c)|^2 + sum (nu / sd)^2 + delta^2, the causes' own parameters free.

    Attributes:
        causes: what was free, none for commissioning errors alone.
        shift: departures there (coordinates,).
        step_share: delta, in units of the discretisation column.
        sizes: departures of the free parameters, cause by cause.
        covariance: of the fault's share of them: what is measured plus the commissioning variance.
        active: coordinates that were fitted, the free ones first (k,).
        posterior: covariance of those departures given the record (k, k).
        chi2: at that point.
        residual: whitened, nuisances and causes taken off (samples,).
        free: whitened direction of each free parameter (samples, k).
        local: linearisation that was used last.
        prediction: channels at that point (rows, c), without the discretisation share.
        columns: of the causes, to go on with; None where they would be computed anew.
        held: nuisances that an end of what is allowed holds: coordinates.
        told: sd of the active departures where model error counts (k,); None: the posterior's.
        farthest: commissioning sd within which its nuisances were held.
    """

    causes: tuple[Hypothesis, ...]
    shift: FloatArray
    step_share: float
    sizes: FloatArray
    covariance: FloatArray
    active: IntArray
    posterior: FloatArray
    chi2: float
    residual: FloatArray
    free: FloatArray
    local: Linearisation
    prediction: SingleArray
    columns: CauseColumns | None = None
    held: IntArray = field(default_factory=lambda: np.zeros(0, int))
    told: FloatArray | None = None
    farthest: float = FARTHEST

    @property
    def pull(self) -> float:
        """Largest commissioning error that the fit needs, in declared sd."""
        runs = self.local.runs
        errors = np.setdiff1d(self.active[len(self.sizes) :], self.active[: len(self.sizes)])
        return float(np.max(np.abs(self.shift[errors]) / runs.sd[errors], initial=0.0))

    @property
    def power(self) -> float:
        """d^2 of the causes: their sizes over their covariance, as the record tells it."""
        count = len(self.sizes)
        known = self.posterior[:count, :count]
        return float(self.sizes @ np.linalg.lstsq(known, self.sizes, rcond=None)[0])


def refine(
    evidence: Evidence,
    causes: tuple[Hypothesis, ...],
    shift: FloatArray,
    local: Linearisation,
    rounds: int = 0,
    step_share: float = 0.0,
    farthest: float = FARTHEST,
    probed: bool = False,
    enough: float = RELATIVE_CONVERGENCE,
    steps: int = ITERATIONS,
    target: float = np.inf,
    known: CauseColumns | None = None,
) -> Fit:
    """Fit causes and nuisances with the full forward.

    Args:
        evidence: what was measured.
        causes: whose parameters are free; none fits commissioning errors alone.
        shift: departures to start from (coordinates,).
        local: nuisance columns to use.
        rounds: how often at most the nuisance columns are computed anew at the fit; ends when
            it has stayed within NEAR of where they were computed, or gains no more by it.
        step_share: of the discretisation column, to start from.
        farthest: commissioning sd within which nuisances are held.
        probed: whether the Jacobian is put right along what is known least at the end: for fits
            whose intervals somebody reads.
        enough: fall of chi^2, of all of it, that is not worth another run.
        steps: at most from one linearisation; fewer than usual are for a first impression, for
            which what the integration step is worth at the fit does not count.
        target: chi^2 that counts: a search ends where it falls too slowly to come down to it.
        known: columns of the causes as an earlier fit left them.
    """
    runs = evidence.runs
    free = (
        np.concatenate([runs.indices(h) for h in causes]).astype(int)
        if causes
        else np.zeros(0, int)
    )
    search = Search(evidence, free, local, farthest, enough, steps, target)
    start = np.clip(shift, search.low, search.high)
    point, jacobian = search.run(search.at(start, step_share), known)
    whole = steps == ITERATIONS and np.isfinite(point.chi2)
    if whole and not near(search.local, point.shift) and not runs.budget.over:
        last, local = _kept(search), _stepped(search, point)
        search = Search(evidence, free, local, farthest, enough, target=target)
        point, jacobian = search.run(search.at(point.shift, point.delta), last)
    for _ in range(rounds):
        if near(search.local, point.shift) or runs.budget.over or not np.isfinite(point.chi2):
            break
        before, last = point.chi2, _kept(search)
        turned = replace(search.local, columns=search.turned)
        local = renewed(turned, point.shift, point.prediction)
        search = Search(evidence, free, local, farthest, enough)
        point, jacobian = search.run(search.at(point.shift, point.delta), last)
        if before - point.chi2 < WORTH * point.chi2:
            break
    if probed and np.isfinite(point.chi2) and not runs.budget.over:
        righted = probe(search, point, jacobian)
        if righted is not jacobian:
            search.steps = ITERATIONS
            point, jacobian = search.descend(point, righted)
    return replace(_fit(causes, search, point, jacobian), farthest=farthest)


def _fit(causes: tuple[Hypothesis, ...], search: Search, point: Point, jacobian: FloatArray) -> Fit:
    """What a search came to, with what it knows of its coordinates."""
    runs, free = search.runs, search.free
    hessian = search.hessian(jacobian)
    spread = np.diag(1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-30)))
    scaled = spread @ hessian @ spread + 1e-12 * np.eye(len(hessian))  # what nothing shows: wide
    inverse = spread @ np.linalg.inv(scaled) @ spread
    posterior = inverse[:-1, :-1] * np.outer(search.unit[:-1], search.unit[:-1])
    count = len(free)
    return Fit(
        causes=causes,
        shift=point.shift,
        step_share=point.delta,
        sizes=point.shift[free],
        covariance=posterior[:count, :count] + np.diag(runs.sd[free] ** 2),
        active=np.concatenate([free, search.nuisances]),
        posterior=posterior,
        chi2=point.chi2,
        residual=point.residual,
        free=jacobian[:, :count],
        local=replace(search.local, columns=search.turned),
        prediction=point.prediction,
        columns=_kept(search) if np.isfinite(point.chi2) else None,
        held=search.held(point.shift),
    )


def _kept(search: Search) -> CauseColumns | None:
    """Columns of the causes, if what the search's runs have turned them to is worth keeping."""
    return search.of_causes if len(search.free) <= TURNED else None


def _stepped(search: Search, point: Point) -> Linearisation:
    """The columns as they are, but for what the step is worth: one run tells that at a point."""
    columns = search.turned.copy()
    finer = search.runs.one(point.shift, refined=True)
    columns[-1] = np.float32(STEP_SD) * (finer - point.prediction)
    return replace(search.local, columns=columns)


def near(local: Linearisation, shift: FloatArray) -> bool:
    """Whether a point is where the nuisance columns were computed, as far as they can tell."""
    sd = local.runs.sd
    moved = np.abs(shift - local.point)
    scale = np.where(sd > 0.0, sd, 0.2 * np.abs(shift) + 1e-12)
    return bool(np.all(moved <= NEAR * scale))


def bare_residual(evidence: Evidence, fit: Fit) -> SingleArray:
    """Measured less predicted (rows, c), the discretisation share taken off, not whitened."""
    share = np.float32(fit.step_share) * fit.local.columns[-1]
    return np.asarray(evidence.measured - fit.prediction - share)


def residual_about(evidence: Evidence, fit: Fit, base: Linearisation) -> FloatArray:
    """Whitened residual as a linear model about a base would have it, for a screen.

    W (y - f(x) - delta c) + N (nu, delta): what the full forward says at the fitted nuisances,
    carried back along the base's columns to where their prior has its mean. Second-order terms of
    strong nuisances, which the projection cannot see, are then gone; so is what the step is worth
    at the fit, where that is another trace than at the base.

    Source: the correction y' = y - (f(nu) - f(0) - J nu).
    """
    runs = evidence.runs
    pull = fit.shift[runs.nuisances] / runs.sd[runs.nuisances]
    for cause in fit.causes:
        pull[np.isin(runs.nuisances, runs.indices(cause))] = 0.0
    share = np.append(pull, fit.step_share).astype(np.float32)
    back = np.tensordot(share, base.columns, axes=1)
    return evidence.whitening.apply(bare_residual(evidence, fit) + back)
