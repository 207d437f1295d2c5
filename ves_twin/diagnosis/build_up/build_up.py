"""build_up: as many causes as held-out data prove, where no few of them explain a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.adequacy import cells, misfit
from ves_twin.diagnosis.build_up.averaged import averaged_half_widths
from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.halves import Halves, carried_point, halves_at
from ves_twin.diagnosis.build_up.idle import idle
from ves_twin.diagnosis.build_up.nearest import nearest
from ves_twin.diagnosis.build_up.offer import Offer, preferred
from ves_twin.diagnosis.build_up.paired import loss
from ves_twin.diagnosis.build_up.plain_selector import PlainSelector
from ves_twin.diagnosis.build_up.proof import Bench, Proof, prove
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.result import BuildUp
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.build_up.simpler import simpler
from ves_twin.diagnosis.build_up.sizes import half_widths
from ves_twin.diagnosis.build_up.trials import Trial
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.explanation import Explanation
from ves_twin.diagnosis.fit_context import FitContext
from ves_twin.diagnosis.preprocess import Dataset
from ves_twin.diagnosis.refine import Fit, bare_residual, refine
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.search import Search
from ves_twin.diagnosis.whitening import Whitening

ROUNDS = 3
"""Times that columns are computed anew where a choice of causes, fitted in full, has moved them."""

EVEN = 1.0
"""White noise that is added to the discrepancy, as a share of its variance, where the choice of
causes is fitted in full: by innovations alone a friction with a gap slides into a wrong one (the
damper), with 10 two joints of TX40 are lost. 0.01, 1 and 10 were tried on TX40 and the damper."""

MOVED = 0.05
"""Share of what is left by which a full fit may differ from the linear one, TX40 moves by less
after two rounds; and by which a round may leave more than the one before (the seven-axis arm: a
third round lost all frictions)."""


@dataclass(frozen=True)
class Built:
    """What building up comes to.

    Attributes:
        found: the explanation with everything that is proved, in units of noise as the page shows
            it. Where nothing is proved, with the few causes that predict best, or that of before.
        before: fit of commissioning errors alone, under the same discrepancy.
        report: what was proved, what is left.
        fitted, held: recordings, or stretches of them, that it was fitted to and proved on.
    """

    found: Explanation
    before: Fit
    report: BuildUp
    fitted: Dataset
    held: Dataset


@dataclass(frozen=True)
class _Builder:
    """A record between its halves.

    Attributes:
        desk: the record before any cause.
        fitted, held: its halves.
    """

    desk: FitContext
    fitted: Dataset
    held: Dataset

    def halves(self, point: FloatArray, present: Sequence[Trial]) -> Halves:
        causes = self.desk.first.screen.bank.hypotheses
        return halves_at(self.fitted, self.held, point, causes, present, self.desk.progress)

    def evidence(self, residual: FloatArray, memory: bool = True) -> Evidence:
        """The fitted half with the discrepancy that a residual shows.

        Sizes that are told are fitted without its memory, by plain squares: where model error is
        a law of the motion and no noise, whitening in time weighs instants that a model gets wrong
        most, and plain squares alone aim at the error that is told. Intervals count the memory.
        """
        whitening = discrepancy(self.fitted.runs, residual, EVEN, memory)
        return Evidence(self.fitted.runs, self.fitted.measured, whitening)

    def chosen(
        self, halves: Halves, point: FloatArray, begin: Sequence[int] = ()
    ) -> tuple[Halves, list[int], FloatArray]:
        """Trials worth a proof, about the point where all of them are fitted in full.

        Args:
            halves: linear about the point.
            point: departures (coordinates,).
            begin: trials that are fitted in full before others are looked at.
        """
        present, only, best = tuple[Trial, ...](), list(begin), np.inf
        for _ in range(ROUNDS + bool(only)):
            regression = halves.regression
            offers = [only] if only else self.offered(regression, _places(halves, present))
            kept = preferred(regression, [self.tried(halves, one, point) for one in offers])
            linear = regression.solve(kept.chosen, kept.evidence.whitening).residual
            if kept.left > best + MOVED:  # columns that hide each other: what was before stays
                break
            best = kept.left
            present = _present([regression.trials[n] for n in kept.chosen], kept.fit)
            off = regression.half.rms(kept.residual - linear)
            point = kept.fit.shift
            halves = self.halves(point, present)
            if only:
                only = []
                continue
            if np.all(off <= MOVED * regression.half.rms(linear)):
                break
            if self.fitted.runs.budget.skips("causes chosen anew about their own fit"):
                break
        return halves, _places(halves, present), point

    def offered(self, regression: Regression, present: Sequence[int]) -> list[list[int]]:
        """What the selection chooses by one-step prediction errors, and by plain squares.

        Neither serves all: whitening in time hides what acts slowly (a double pendulum's
        frictions, an excavator's valve), and plain squares have few independent rows (TX40).
        """
        both = (Selector(regression).run(present), PlainSelector(regression).run(present))
        return list({tuple(sorted(one)): one for one in both}.values())

    def tried(self, halves: Halves, chosen: list[int], point: FloatArray) -> Offer:
        """Chosen trials fitted in full."""
        evidence = self.evidence(halves.regression.fit(chosen).residual)
        fit = self.refined(halves, chosen, point, evidence)
        return Offer.of(halves.regression, chosen, evidence, fit)

    def onward(
        self, halves: Halves, few: Proof, point: FloatArray
    ) -> tuple[Halves, Proof, FloatArray]:
        """What is proved about a few causes fitted in full, where it holds them; else the few.

        A dead band hides what else acts on a command until both are where they belong (seen on the
        excavator).
        """
        if self.fitted.runs.budget.skips("further causes beside the best pair"):
            return halves, few, point
        there, chosen, at = self.chosen(halves, point, few.proved)
        more = prove(there.regression, there.held, chosen, more=few.tested)
        held = {there.regression.trials[n].cause.label for n in more.proved}
        if not {halves.regression.trials[n].cause.label for n in few.proved} <= held:
            return halves, few, point
        return there, more, at

    def at_work(
        self, halves: Halves, proof: Proof, point: FloatArray, evidence: Evidence
    ) -> tuple[Proof, Fit]:
        """What is proved and still takes something away where all of it is fitted in full."""
        while True:
            fit = self.refined(halves, proof.proved, point, evidence, probed=True)
            gone = idle(proof, self.fitted.runs, self.held, fit)
            if gone is None:
                return proof, fit
            proof = replace(
                proof,
                proved=tuple(n for n in proof.proved if n != gone),
                dropped={**proof.dropped, gone: 1.0},
            )

    def near(self, halves: Halves, proof: Proof) -> Fit | None:
        """Few causes that are not proved, fitted in full; None where they do not predict better."""
        origin, regression = self.fitted.runs.origin, halves.regression
        trials = nearest(proof.bench, Selector(regression).best())
        if not trials:
            return None
        evidence = self.evidence(regression.fit(trials).residual, memory=False)
        at_work, fit = self.at_work(halves, replace(proof, proved=trials), origin, evidence)
        return fit if at_work.proved else None

    def refined(
        self,
        halves: Halves,
        chosen: Sequence[int],
        point: FloatArray,
        evidence: Evidence,
        probed: bool = False,
    ) -> Fit:
        """Chosen trials fitted with the full forward, from what the linear fit says.

        And from the sizes that bent columns were computed at, the better of both: with a dead band
        and what saturates beyond it the likeliest start led to half as good a fit (the excavator).
        """
        regression, runs = halves.regression, self.fitted.runs
        linear = regression.solve(chosen, evidence.whitening)
        full = np.where(runs.sd > 0.0, point, 0.0)
        near, half, told = full, full, full
        for n, at in regression.places(chosen).items():
            trial = regression.trials[n]
            where = runs.indices(trial.cause)
            sizes = trial.departures(linear.shares[at] * linear.scale[at])
            full = runs.depart(full, where, sizes)
            told = runs.depart(told, where, np.array(trial.sizes) if trial.bent else full[where])
            here = point[where] if np.any(point[where]) else full[where]
            near = runs.depart(near, where, here)
            half = runs.depart(half, where, 0.5 * (here + full[where]))
        causes = tuple(regression.trials[n].cause for n in chosen)
        starts = (_likeliest(evidence, (full, half, near)), told)
        different = {shift.tobytes(): shift for shift in starts}
        fits = [converged(evidence, causes, point, shift) for shift in different.values()]
        fit = min(fits, key=lambda one: one.chi2)
        if not probed:
            return fit
        return refine(evidence, causes, fit.shift, fit.local, 0, fit.step_share, probed=True)


def build_up(desk: FitContext, start: Explanation, fitted: Dataset, held: Dataset) -> Built | None:
    """Choose causes on one half of the data, prove each on the other.

    Args:
        desk: the record and what noise does.
        start: the best single cause, or pair, in units of noise.
        fitted: recordings that sizes come from.
        held: recordings that prove them.

    Returns:
        What is proved and what is left; None where the library has nothing to offer.
    """
    builder = _Builder(desk, fitted, held)
    desk.progress(0.0, "building up")
    origin = fitted.runs.origin
    halves, chosen, point = builder.chosen(builder.halves(origin, ()), origin)
    first = prove(halves.regression, halves.held, chosen)
    proof = _no_worse(halves, first)
    if not proof.tested:
        return None
    if proof.proved != first.proved:
        halves, proof, point = builder.onward(halves, proof, point)
    evidence = builder.evidence(proof.bench.fit.residual, memory=False)
    proof, final = builder.at_work(halves, simpler(proof), point, evidence)
    before = builder.refined(halves, (), point, evidence)
    there = held.runs.one(carried_point(fitted.runs, held.runs, final.shift))
    ends = (
        np.asarray(bare_residual(evidence, final), float),
        np.asarray(held.measured - there, float),
    )
    shown = final if proof.proved else builder.near(halves, proof)
    plain = Evidence(fitted.runs, fitted.measured, _on(start.evidence.whitening, fitted.runs))
    found, before = start, _in_noise(plain, before)
    if shown is not None:
        sure = _widened(evidence, shown, desk.settings.confidence, halves.regression, proof.proved)
        found = _explained(desk, start, _in_noise(plain, sure))
    return Built(found, before, report_of(halves, proof, ends), fitted, held)


def _likeliest(evidence: Evidence, starts: Sequence[FloatArray]) -> FloatArray:
    """The start that leaves least: columns of finite sizes may promise what none of them keeps.

    Seen on the excavator.
    """

    def left(shift: FloatArray) -> float:
        rows = evidence.whitening.apply(evidence.measured - evidence.runs.one(shift))
        chi2 = float(rows @ rows)
        return chi2 if np.isfinite(chi2) else np.inf

    different = {shift.tobytes(): shift for shift in starts}
    return min(different.values(), key=left)


def _places(halves: Halves, present: Sequence[Trial]) -> list[int]:
    return [n for n, trial in enumerate(halves.regression.trials) if trial in present]


def _present(trials: Sequence[Trial], fit: Fit) -> tuple[Trial, ...]:
    """The same causes at the sizes of a fit; those that came to nothing are gone."""
    found, start = [], 0
    for trial in trials:
        count = len(trial.cause.parameters)
        sizes = tuple(fit.sizes[start : start + count].tolist())
        start += count
        if any(sizes):
            found.append(replace(trial, sizes=sizes, positive=True, bent=True))
    return tuple(found)


def _no_worse(halves: Halves, proof: Proof) -> Proof:
    """The proof, or that of the best single cause or pair where it predicts better."""
    regression, best = halves.regression, proof
    for few in Selector(regression).best():
        if set(few) <= set(best.proved):
            continue
        other = prove(regression, halves.held, few, more=best.tested)
        best = replace(best, tested=other.tested)
        if set(other.proved) == set(few) and _worse(proof.bench, best.proved, few):
            best = other
    return best


def _worse(bench: Bench, some: Sequence[int], others: Sequence[int]) -> bool:
    """Whether some trials predict all held-out channels worse than others, by robust loss."""
    every = list(dict.fromkeys([*bench.fit.chosen, *some, *others]))
    common = replace(bench, fit=bench.regression.solve(every, bench.fit.whitening))
    scale = common.scale(every)
    one, two = (loss(common.innovations(part), scale)[common.whole] for part in (some, others))
    return bool(np.sum(one) > np.sum(two))


def _on(whitening: Whitening, runs: Runs) -> Whitening:
    """The same noise on the fitted half."""
    return replace(whitening, runs=runs)


def _in_noise(evidence: Evidence, fit: Fit) -> Fit:
    """With what is known of departures in units of noise, as a held-out gain carries it over.

    Against the discrepancy they are so uncertain that what a model gets wrong elsewhere would pass
    for its tuning.
    """
    count = len(fit.sizes)
    search = Search(evidence, fit.active[:count], fit.local)
    point = search.at(fit.shift, fit.step_share)
    hessian = search.hessian(search.jacobian(point))
    root = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-30))
    scaled = hessian * np.outer(root, root) + 1e-12 * np.eye(len(hessian))
    inverse = (np.linalg.inv(scaled) * np.outer(root, root))[:-1, :-1]
    return replace(fit, posterior=inverse * np.outer(search.unit[:-1], search.unit[:-1]))


def _widened(
    evidence: Evidence,
    fit: Fit,
    confidence: float,
    regression: Regression,
    proved: Sequence[int],
) -> Fit:
    """With intervals that count what stretches of time scatter by, and what else may be there."""
    if not len(fit.sizes):
        return fit
    left = np.asarray(bare_residual(evidence, fit), float)
    wide = averaged_half_widths(regression, proved, evidence.whitening, left, confidence)
    names = [name for cause in fit.causes for name in cause.parameters]
    half = half_widths(evidence, fit, confidence)
    half = np.maximum(half, [wide.get(name, 0.0) for name in names])
    sd = half / float(norm.isf(0.5 * (1.0 - confidence)))
    own = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    grown = np.maximum(sd / own, 1.0)
    return replace(fit, covariance=fit.covariance * np.outer(grown, grown))


def _explained(desk: FitContext, start: Explanation, final: Fit) -> Explanation:
    """The fit as an explanation in units of noise."""
    evidence = Evidence(
        desk.first.evidence.runs, desk.first.evidence.measured, start.evidence.whitening
    )
    residual = evidence.whitening.apply(bare_residual(evidence, final))
    shown = replace(final, residual=residual, chi2=float(residual @ residual))
    before = cells(evidence.whitening, start.commissioning.residual)
    after = cells(evidence.whitening, residual)
    score = misfit(after, before, desk.settings.model_error)
    return replace(
        start,
        fits=(shown, *start.fits),
        chosen=(shown,),
        weights=(1.0,),
        adequate=score < desk.thresholds.misfit,
        score=score,
        second=None,
        before=tuple(before),
        after=tuple(after),
    )
