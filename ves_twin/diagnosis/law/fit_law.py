"""fit_law: numbers of a law, its prior's smoothness, commissioning errors, by the full forward."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.linearise import STEP_SD, Linearisation
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.smoothness import Smoothness, smoothest
from ves_twin.diagnosis.law.with_law import WithLaw
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs

ROUNDS = 8
"""Linearisations at most."""

SHARES = (1.0, 0.5, 0.2, 0.05)
"""Of a Gauss-Newton step, the first that helps is taken."""

ENOUGH = 1.0
"""Fall of chi^2 that ends a fit: a nat is 2."""

ENOUGH_SHARE = 2e-3
"""The same as a share of chi^2 beyond noise, while the fit is far off: of the noise itself, on
15000 samples, it would be 15 nats."""

NUISANCE_STEP = 0.5
"""Finite difference of a commissioning error, in its sd."""

CHOICE = 1.5
"""Nats that a number costs which was chosen by evidence and not marginalised."""

AWAY = 30.0
"""Commissioning sd beyond which a fit is lost."""


@dataclass(frozen=True)
class LawFit:
    """The most probable law of a family.

    Attributes:
        candidate: the family; None for commissioning errors alone.
        fit: departures, residual, posterior, as of a cause; its chi^2 has the law's prior too.
        prior: precision of all coordinates about their prior means, in units of `unit`.
        jacobian: whitened columns of the law's numbers, the nuisances, and the step (samples, k).
        log_evidence: Laplace's approximation [nats].
    """

    candidate: Candidate | None
    fit: Fit
    jacobian: FloatArray
    log_evidence: float

    @cached_property
    def numbers(self) -> FloatArray:
        """Of the law (k,)."""
        if self.candidate is None:
            return np.zeros(0)
        return self.candidate.start + self.fit.sizes

    @property
    def count(self) -> int:
        """Numbers that were fitted beside commissioning errors."""
        return len(self.fit.sizes)

    @cached_property
    def point(self) -> FloatArray:
        """Law, commissioning errors in sd, and step share: what the Jacobian's columns count."""
        fit = self.fit
        errors = fit.active[self.count :]
        return np.concatenate(
            [fit.sizes, fit.shift[errors] / fit.local.runs.sd[errors], [fit.step_share]]
        )

    @property
    def temper(self) -> float:
        """Weight of priors: chi^2 a sample, where that is more than noise."""
        return max(1.0, float(np.mean(np.square(self.fit.residual))))


def fit_law(
    evidence: Evidence,
    candidate: Candidate | None,
    start: Fit,
    numbers: FloatArray | None = None,
    rounds: int = ROUNDS,
) -> LawFit:
    """Fit a law together with commissioning errors.

    Gauss-Newton with the law inside every run, since a law of speed changes the very motion it
    depends on. While chi^2 a sample is above 1 the priors weigh by it, so that a wrong law does
    not strain commissioning errors. The size s and length l of a smooth prior c ~ N(0, s^2 K_l)
    are those of largest evidence in each linearisation.

    Args:
        evidence: what was measured; its runs are of a `LawForward`.
        candidate: the family; None fits commissioning errors alone.
        start: a fit whose commissioning errors are begun with.
        numbers: of the law to begin with; those of the family if None.
        rounds: linearisations at most.
    """
    return _Fitter.of(evidence, candidate, start).run(start, numbers, rounds)


def ended(fall: float, square: float, samples: int) -> bool:
    """Whether a step that makes chi^2 fall from a square by so much is the last one."""
    return fall < max(ENOUGH, ENOUGH_SHARE * (square - samples))


@dataclass(frozen=True)
class _Fitter:
    """What stays the same through a fit; coordinates: law, nuisances, step share.

    `kept` are the columns of nuisances and step that a lean fit keeps; None computes them anew.
    """

    evidence: Evidence
    runs: Runs
    candidate: Candidate | None
    law: IntArray
    nuisances: IntArray
    kept: SingleArray | None

    @staticmethod
    def of(evidence: Evidence, candidate: Candidate | None, start: Fit) -> _Fitter:
        runs = evidence.runs
        if candidate is not None:
            forward = WithLaw(runs.forward, (candidate,))  # type: ignore[arg-type]  # a LawForward
            runs = replace(runs, forward=forward)
        law = runs.indices(candidate.hypothesis).astype(int) if candidate else np.zeros(0, int)
        kept = start.local.columns if isinstance(evidence, LeanEvidence) else None
        return _Fitter(evidence, runs, candidate, law, runs.nuisances, kept)

    @cached_property
    def where(self) -> IntArray:
        """Coordinates that are fitted."""
        return np.concatenate([self.law, self.nuisances])

    @cached_property
    def unit(self) -> FloatArray:
        """What a unit of each fitted coordinate is, and of the step's share (k + 1,)."""
        return np.concatenate([np.ones(len(self.law)), self.runs.sd[self.nuisances], [1.0]])

    @cached_property
    def mean(self) -> FloatArray:
        """Prior means as departures, in units (k + 1,)."""
        found = np.zeros(len(self.unit))
        if self.candidate is not None:
            found[: len(self.law)] = self.candidate.mean - self.candidate.start
        return found

    def precision(self, smoothness: Smoothness | None) -> FloatArray:
        """Of the prior, in units (k + 1, k + 1)."""
        found = np.eye(len(self.unit))
        count = len(self.law)
        if self.candidate is None or not count:
            return found
        if self.candidate.kernels:
            found[:count, :count] = 0.0
            if smoothness is not None:
                kernel = self.candidate.kernels[smoothness.length]
                found[:count, :count] = np.linalg.inv(smoothness.size**2 * kernel)
        else:
            found[:count, :count] = np.diag(1.0 / np.square(self.candidate.sd))
        return found

    def run(self, start: Fit, numbers: FloatArray | None, rounds: int) -> LawFit:
        point = np.zeros(len(self.unit))
        pairs = zip(start.local.runs.coordinates, start.shift.tolist(), strict=True)
        begun = {(axis.parameter.name, axis.recording): value for axis, value in pairs}
        for n, i in enumerate(self.nuisances, len(self.law)):
            axis = self.runs.coordinates[i]
            point[n] = begun.get((axis.parameter.name, axis.recording), 0.0) / self.unit[n]
        if self.candidate is not None and numbers is not None:
            point[: len(self.law)] = numbers - self.candidate.start
        point[-1] = start.step_share
        look = self.look(point)
        smoothness: Smoothness | None = None
        for _ in range(rounds):
            smoothness = self.smoothness(look) or smoothness
            better = self.step(look, smoothness)
            if better is None:
                break
            fall = look.energy - better.energy
            moved = self.look(better.point, better)
            stop = ended(fall, look.energy, len(look.residual))
            look = moved
            if stop:
                break
        return self.finished(look, smoothness, start)

    def look(self, point: FloatArray, there: _Bare | None = None) -> _Look:
        """Prediction and columns at a point."""
        shift = self.shift(point)
        prediction = self.runs.one(shift) if there is None else there.prediction
        if self.kept is None:
            finer = np.float32(STEP_SD) * (self.runs.one(shift, refined=True) - prediction)
            moved = self.moved(shift, prediction, slice(None))
            columns = np.concatenate([moved, finer[None]])
        else:
            columns = np.concatenate([self.of_law(point, shift, prediction), self.kept])
        columns[~np.isfinite(columns).all(axis=(1, 2))] = 0.0
        jacobian = self.evidence.whitening.apply(columns).T
        bare = self.bare(point, prediction, columns[-1])
        return _Look(point, prediction, bare.residual, columns, jacobian)

    def of_law(self, point: FloatArray, shift: FloatArray, prediction: SingleArray) -> SingleArray:
        """Columns of a law's numbers in a lean fit."""
        count = len(self.law)
        if self.candidate is None or not isinstance(self.evidence, LeanEvidence):
            return self.moved(shift, prediction, slice(0))
        hats, numbers = self.evidence.hats, self.candidate.start + point[:count]
        known = hats.changes(self.candidate, numbers)
        if known is None:
            known = self.moved(shift, prediction, slice(count))
            hats.keep(self.candidate, known)
        return known

    def moved(self, shift: FloatArray, prediction: SingleArray, of: slice) -> SingleArray:
        """Columns of some coordinates by differences."""
        steps = np.full(len(self.where), NUISANCE_STEP)
        if self.candidate is not None:
            steps[: len(self.law)] = self.candidate.steps
        where, units, steps = self.where[of], self.unit[:-1][of], steps[of]
        moved = [
            self.runs.depart(shift, np.array([i]), shift[i] + step * unit)
            for i, step, unit in zip(where, steps, units, strict=True)
        ]
        ends = np.array([m[i] - shift[i] for m, i in zip(moved, where, strict=True)])
        for n in np.flatnonzero(ends == 0.0):  # at a bound
            moved[n] = self.runs.depart(
                shift, np.array([where[n]]), shift[where[n]] - steps[n] * units[n]
            )
            ends[n] = moved[n][where[n]] - shift[where[n]]
        share = (units / ends).astype(np.float32)[:, None, None]
        return np.asarray((self.runs.many(moved) - prediction) * share)

    def shift(self, point: FloatArray) -> FloatArray:
        """Departures of a point."""
        return self.runs.depart(self.runs.origin, self.where, point[:-1] * self.unit[:-1])

    def bare(self, point: FloatArray, prediction: SingleArray, step: SingleArray) -> _Bare:
        off = self.evidence.measured - prediction - np.float32(point[-1]) * step
        return _Bare(point, prediction, self.evidence.whitening.apply(off))

    def smoothness(self, look: _Look) -> Smoothness | None:
        """Of largest evidence in this linearisation."""
        if self.candidate is None or not self.candidate.kernels:
            return None
        count = len(self.law)
        others = look.jacobian[:, count:]
        z = look.residual + look.jacobian @ look.point
        return smoothest(look.jacobian[:, :count], others, z, look.temper, self.candidate)

    def step(self, look: _Look, smoothness: Smoothness | None) -> _Bare | None:
        """The best of a few shares of the Gauss-Newton step; None if none helps."""
        prior = self.precision(smoothness) * look.temper
        hessian = look.jacobian.T @ look.jacobian + prior
        slope = look.jacobian.T @ look.residual - prior @ (look.point - self.mean)
        move = _solved(hessian, slope)
        cost = self.cost(look.energy, look.point, prior)
        for share in SHARES:
            point = look.point + share * move
            if np.any(np.abs(point[len(self.law) : -1]) > AWAY):
                continue
            bare = self.bare(point, self.runs.one(self.shift(point)), look.columns[-1])
            new = self.cost(bare.energy, point, prior)
            if np.isfinite(new) and new < cost:
                return bare
        return None

    def cost(self, energy: float, point: FloatArray, prior: FloatArray) -> float:
        off = point - self.mean
        return energy + float(off @ prior @ off)

    def finished(self, look: _Look, smoothness: Smoothness | None, start: Fit) -> LawFit:
        prior = self.precision(smoothness)
        hessian = look.jacobian.T @ look.jacobian + prior
        scale = 1.0 / np.sqrt(np.diag(hessian))
        scaled = hessian * np.outer(scale, scale)
        posterior = np.linalg.inv(scaled) * np.outer(scale, scale)
        chi2 = self.cost(look.energy, look.point, prior)
        logdet = float(np.linalg.slogdet(scaled)[1] - 2.0 * np.sum(np.log(scale)))
        chosen = self.candidate.chosen if self.candidate else 0
        log_evidence = -0.5 * (chi2 + logdet - _logdet(prior)) - CHOICE * chosen
        shift, count = self.shift(look.point), len(self.law)
        local = Linearisation(
            self.runs, shift, look.prediction, look.columns[count:], start.local.bends
        )
        outer = np.outer(self.unit[:-1], self.unit[:-1])
        spread = posterior[:-1, :-1] * outer
        fit = Fit(
            causes=(self.candidate.hypothesis,) if self.candidate else (),
            shift=shift,
            step_share=float(look.point[-1]),
            sizes=shift[self.law],
            covariance=spread[:count, :count],
            active=self.where,
            posterior=spread,
            chi2=chi2,
            residual=look.residual,
            free=look.jacobian[:, :count],
            local=local,
            prediction=look.prediction,
        )
        return LawFit(self.candidate, fit, look.jacobian, log_evidence)


@dataclass(frozen=True)
class _Bare:
    """A point with its prediction and its whitened residual."""

    point: FloatArray
    prediction: SingleArray
    residual: FloatArray

    @property
    def energy(self) -> float:
        return float(self.residual @ self.residual)


@dataclass(frozen=True)
class _Look(_Bare):
    """With columns for a unit of each coordinate: in the channels' units, and whitened."""

    columns: SingleArray
    jacobian: FloatArray

    @property
    def temper(self) -> float:
        """Weight of the priors."""
        return max(1.0, self.energy / len(self.residual))


def _solved(hessian: FloatArray, slope: FloatArray) -> FloatArray:
    scale = 1.0 / np.sqrt(np.diag(hessian))
    scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(hessian))
    return np.asarray(scale * cho_solve(cho_factor(scaled), scale * slope))


def _logdet(matrix: FloatArray) -> float:
    return float(np.linalg.slogdet(matrix)[1])
