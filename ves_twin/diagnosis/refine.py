"""refine: the most probable size of a cause, together with the nuisances, by the full forward."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.linearise import Linearisation, linearise
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.whitening import Whitening
from ves_twin.types import FloatArray, IntArray, SingleArray

ITERATIONS = 40
"""Steps at most from one linearisation."""

FARTHEST = 30.0
"""Nuisances are held within this many commissioning sd: a search that leaves them is lost."""

CONVERGED = 0.02
"""Fall of chi^2 that is not worth another run; names turn on differences of 9 and more."""

WORTHLESS = 1e-4
"""The same, of all of chi^2: what is lost and won by chance where parts stick and slip."""

NEAR = 0.3
"""Commissioning sd within which nuisance columns are taken to hold; absent parameters: 6 %."""

FORWARD_STEP = 1.0
"""Commissioning sd of a one-sided difference at a fit."""

WORTH = 3e-4
"""Fall of chi^2, of all of it, below which another linearisation is not worth its runs."""

BENT = 0.01
"""Squared error [sigma^2] of a predicted change above which the Jacobian is turned: single
precision makes 1e-6 of it, and a smaller error moves no estimate."""

LEAST_MOVE = 1.0
"""Move [sd] below which the columns learn less from it: a rig that sticks and slips answers some
7 sigma off by chance, whatever the move."""

DAMPING = 10.0
"""First weight, and growth of the weight, that a step which did not help adds to the priors: a
strong commissioning error that is a little off its column leaks into weak ones, many sd of them."""

ATTEMPTS = 4
"""Dampings that are tried before a search ends."""


@dataclass(frozen=True)
class Evidence:
    """What was measured, on the analysis grid (rows, c), and how its noise is whitened."""

    runs: Runs
    measured: SingleArray
    whitening: Whitening


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

    @property
    def pull(self) -> float:
        """Largest commissioning error that the fit needs, in declared sd."""
        runs = self.local.runs
        errors = np.setdiff1d(self.active[len(self.sizes) :], self.active[: len(self.sizes)])
        return float(np.max(np.abs(self.shift[errors]) / runs.sd[errors], initial=0.0))


@dataclass(frozen=True)
class _Point:
    shift: FloatArray
    delta: float
    prediction: SingleArray
    residual: FloatArray
    chi2: float


class _Search:
    """Gauss-Newton in whitened space; the Jacobian follows the runs it makes anyway (Broyden).

    J has a column for each free parameter, for one sd of each nuisance, and for delta. After a
    move m that changed the prediction by c instead of J m it becomes J + (c - J m) m' / m'm, so
    columns that no longer hold turn right without a run of their own. They are turned before
    whitening too, for whoever goes on from the fit, with another noise or another cause.

    Source: Broyden 1965, the good update.
    """

    def __init__(self, evidence: Evidence, free: IntArray, local: Linearisation) -> None:
        runs = evidence.runs
        self.evidence, self.runs, self.free, self.local = evidence, runs, free, local
        self.kept = np.flatnonzero(~np.isin(runs.nuisances, free))
        self.nuisances = runs.nuisances[self.kept]
        self.turned = local.columns.copy()
        picked = local.columns[[*self.kept, len(runs.nuisances)]]
        self.columns = evidence.whitening.apply(picked).T
        self.low = runs.low.copy()
        self.high = runs.high.copy()
        reach = FARTHEST * runs.sd[self.nuisances]
        self.low[self.nuisances] = np.maximum(self.low[self.nuisances], -reach)
        self.high[self.nuisances] = np.minimum(self.high[self.nuisances], reach)
        self.damping = 0.0
        self.unit = np.ones(len(free) + len(self.nuisances) + 1)
        self.unit[len(free) : -1] = runs.sd[self.nuisances]

    def at(self, shift: FloatArray, delta: float) -> _Point:
        prediction = self.runs.one(shift)
        if not np.all(np.isfinite(prediction)):
            return _Point(shift, delta, prediction, np.zeros(0), np.inf)
        difference = self.evidence.measured - prediction
        residual = self.evidence.whitening.apply(
            difference - np.float32(delta) * self.local.columns[-1]
        )
        pull = shift[self.nuisances] / self.runs.sd[self.nuisances]
        chi2 = float(residual @ residual + pull @ pull + delta**2)
        return _Point(shift, delta, prediction, residual, chi2)

    def jacobian(self, point: _Point) -> FloatArray:
        """Columns at a point: free parameters by a step of 4 %, nuisances as they were given."""
        columns, raw = [], []
        for n, i in enumerate(self.free):
            step = 0.04 * abs(point.shift[i]) + 1e-3 * self.runs.sd[i]
            step = max(step, 1e-5 * (self.high[i] - self.low[i]))
            if point.shift[i] + step > self.high[i]:
                step = -step
            moved = point.shift.copy()
            moved[i] += step
            change = self.runs.one(moved) - point.prediction
            self.unit[n] = abs(step)
            raw.append(change * np.float32(np.sign(step)))
            columns.append(self.evidence.whitening.apply(raw[-1]))
        self.raw = np.array(raw, np.float32).reshape(-1, *point.prediction.shape)
        free = np.array(columns).reshape(-1, len(point.residual)).T
        return np.concatenate([free, self.columns], axis=1)

    def hessian(self, jacobian: FloatArray, damping: float = 0.0) -> FloatArray:
        prior = np.full(len(self.unit), 1.0 + damping)
        prior[: len(self.free)] = 0.0
        return np.asarray(jacobian.T @ jacobian + np.diag(prior))

    def run(self, point: _Point) -> tuple[_Point, FloatArray]:
        if not np.isfinite(point.chi2):
            return point, np.zeros((0, len(self.unit)))
        jacobian = self.jacobian(point)
        for _ in range(ITERATIONS):
            found = self._step(point, jacobian)
            fall = point.chi2 - found.chi2
            point = found
            if fall < CONVERGED + WORTHLESS * point.chi2:
                break
        return point, jacobian

    def _turn(self, change: SingleArray, move: FloatArray) -> None:
        """The same before whitening; only what belongs to the nuisances is kept."""
        here = move.astype(np.float32)
        count = len(self.free)
        change = change - np.tensordot(here[:count], self.raw, axes=1)
        change -= np.tensordot(here[count:-1], self.turned[self.kept], axes=1)
        share = here / np.float32(move @ move + LEAST_MOVE**2)
        self.raw += share[:count, None, None] * change
        self.turned[self.kept] += share[count:-1, None, None] * change

    def _step(self, point: _Point, jacobian: FloatArray) -> _Point:
        """The next point, or the same one if none is better; updates the Jacobian in place.

        Source: Marquardt 1963, with the priors' own unit as the scale of the damping.
        """
        axes = np.concatenate([self.free, self.nuisances])
        here = np.append(point.shift[axes], point.delta) / self.unit
        prior = np.where(np.arange(len(here)) < len(self.free), 0.0, here)
        for _ in range(ATTEMPTS):
            hessian = self.hessian(jacobian, self.damping)
            scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-30))
            scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(scale))
            gradient = jacobian.T @ point.residual - prior
            there = here + scale * np.linalg.solve(scaled, scale * gradient)
            shift = point.shift.copy()
            shift[axes] = (there * self.unit)[:-1]
            trial = self.at(np.clip(shift, self.low, self.high), float(there[-1]))
            if np.isfinite(trial.chi2):
                self._learn(point, trial, jacobian, np.append(trial.shift[axes], trial.delta))
            if trial.chi2 < point.chi2:
                self.damping = self.damping / DAMPING if self.damping > DAMPING else 0.0
                return trial
            self.damping = DAMPING * max(self.damping, 1.0)
        return point

    def _learn(self, point: _Point, trial: _Point, jacobian: FloatArray, there: FloatArray) -> None:
        axes = np.concatenate([self.free, self.nuisances])
        move = (there - np.append(point.shift[axes], point.delta)) / self.unit
        surprise = point.residual - trial.residual - jacobian @ move
        if surprise @ surprise > BENT:
            jacobian += np.outer(surprise, move / (move @ move + LEAST_MOVE**2))
            self._turn(trial.prediction - point.prediction, move)


def refine(
    evidence: Evidence,
    causes: tuple[Hypothesis, ...],
    shift: FloatArray,
    local: Linearisation,
    rounds: int = 0,
    step_share: float = 0.0,
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
    """
    runs = evidence.runs
    free = (
        np.concatenate([runs.indices(h) for h in causes]).astype(int)
        if causes
        else np.zeros(0, int)
    )
    search = _Search(evidence, free, local)
    start = np.clip(shift, search.low, search.high)
    point, jacobian = search.run(search.at(start, step_share))
    for _ in range(rounds):
        if _near(runs, search, point.shift):
            break
        before = point.chi2
        local = linearise(runs, point.shift, forward_step=FORWARD_STEP)
        search = _Search(evidence, free, local)
        point, jacobian = search.run(search.at(point.shift, point.delta))
        if before - point.chi2 < WORTH * point.chi2:
            break
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
    )


def _near(runs: Runs, search: _Search, shift: FloatArray) -> bool:
    """Whether a point is where the nuisance columns were computed, as far as they can tell."""
    moved = np.abs(shift - search.local.point)
    scale = np.where(runs.sd > 0.0, runs.sd, 0.2 * np.abs(shift) + 1e-12)
    return bool(np.all(moved <= NEAR * scale))


def bare_residual(evidence: Evidence, fit: Fit) -> SingleArray:
    """Measured less predicted (rows, c), the discretisation share taken off, not whitened."""
    share = np.float32(fit.step_share) * fit.local.columns[-1]
    return np.asarray(evidence.measured - fit.prediction - share)


def residual_about(evidence: Evidence, fit: Fit, base: Linearisation) -> FloatArray:
    """Whitened residual as a linear model about a base would have it, for a screen.

    W (y - f(x)) + N nu: what the full forward says at the fitted nuisances, carried back along the
    base's columns to where their prior has its mean. Second-order terms of strong nuisances, which
    the projection cannot see, are then gone.

    Source: the correction y' = y - (f(nu) - f(0) - J nu).
    """
    runs = evidence.runs
    pull = fit.shift[runs.nuisances] / runs.sd[runs.nuisances]
    for cause in fit.causes:
        pull[np.isin(runs.nuisances, runs.indices(cause))] = 0.0
    back = np.tensordot(pull.astype(np.float32), base.columns[:-1], axes=1)
    return evidence.whitening.apply(evidence.measured - fit.prediction + back)
