"""build_up: as many causes as held-out data prove, where no few of them explain a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.averaged import averaged_half_widths
from ves_twin.diagnosis.build_up.builder import Builder, Start
from ves_twin.diagnosis.build_up.each_by_itself import each_by_itself
from ves_twin.diagnosis.build_up.halves import Halves, carried_point
from ves_twin.diagnosis.build_up.idle import idle, missed
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.in_its_place import Replaced
from ves_twin.diagnosis.build_up.nearest import nearest
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.result import UNFINISHED, BuildUp
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.build_up.simpler import simpler
from ves_twin.diagnosis.build_up.sizes import half_widths
from ves_twin.diagnosis.build_up.within_range import within_range
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.refine import Fit, bare_residual
from ves_twin.diagnosis.fit.search import Search
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import Whitening


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


def build_up(
    desk: FitContext,
    start: Explanation,
    fitted: Dataset,
    held: Dataset,
    begin: Start | None = None,
) -> Built | None:
    """Choose causes on one half of the data, prove each on the other.

    Args:
        desk: the record and what noise does.
        start: the best single cause, or pair, in units of noise.
        fitted: recordings that sizes come from.
        held: recordings that prove them.
        begin: where choosing begins; the model as it is if None.

    Returns:
        What is proved and what is left; None where the library has nothing to offer.
    """
    builder = Builder(desk, fitted, held)
    desk.progress(0.0, "building up")
    found = builder.best(begin)
    halves, point, budget = found.halves, found.point, builder.fitted.runs.budget
    budget.stage(1.0)
    proof = found.proof
    if not proof.tested:
        return None
    desk.progress(0.0, "fitting what is proved, and its intervals")
    evidence = builder.evidence(proof.bench.fit.residual, memory=False, apart=proof.judges.apart)
    proof, final = _at_work(
        halves, each_by_itself(simpler(proof)), point, evidence, held, found.fit
    )
    proof, final = within_range(proof, final, point, evidence)
    before = in_full(halves.regression, (), point, evidence)
    if budget.over:
        budget.leave_out(UNFINISHED)
    points = final.shift, carried_point(fitted.runs, held.runs, final.shift)
    ends = (
        np.asarray(bare_residual(evidence, final), float),
        np.asarray(held.measured - held.runs.one(points[1]), float),
    )
    shown = final if proof.proved else _near(builder, halves, proof)
    plain = Evidence(fitted.runs, fitted.measured, _on(start.evidence.whitening, fitted.runs))
    told, before = start, _in_noise(plain, before)
    if shown is not None:
        sure = _widened(evidence, shown, desk.settings.confidence, halves.regression, proof.proved)
        told = _explained(desk, start, _in_noise(plain, sure))
    replaced = Replaced(proof, final, desk.first.screen.bank, evidence, held, desk.progress)
    report = report_of(halves, proof, ends, points, replaced)
    return Built(told, before, report, fitted, held)


def _at_work(
    halves: Halves,
    proof: Proof,
    point: FloatArray,
    evidence: Evidence,
    held: Dataset,
    known: Fit | None = None,
) -> tuple[Proof, Fit]:
    """What is proved and still takes something away where all of it is fitted in full."""

    def fitted(trials: Sequence[int]) -> Fit:
        return in_full(halves.regression, trials, point, evidence, probed=True, known=known)

    fit = fitted(proof.proved)
    while (gone := idle(proof, evidence.runs, held, fit)) is not None:
        rest = tuple(n for n in proof.proved if n != gone)
        other = fitted(rest)
        if missed(proof, gone, evidence.runs, held, (fit, other)):
            break
        dropped = {**proof.dropped, gone: _p_of(proof, gone)}
        proof, fit = replace(proof, proved=rest, dropped=dropped), other
    return proof, fit


def _p_of(proof: Proof, trial: int) -> float:
    """Its p, where it was put to proof."""
    return proof.differences[trial].p if trial in proof.differences else 1.0


def _near(builder: Builder, halves: Halves, proof: Proof) -> Fit | None:
    """Few causes that are not proved, fitted in full; None where they do not predict better."""
    regression, origin = halves.regression, builder.fitted.runs.origin
    trials = nearest(proof.bench, Selector(regression).best())
    if not trials:
        return None
    evidence = builder.evidence(regression.fit(trials).residual, memory=False)
    few = replace(proof, proved=trials, judges=proof.judges.fitted(trials))
    left, fit = _at_work(halves, few, origin, evidence, builder.held)
    return fit if left.proved else None


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
    told = half_widths(evidence, fit, confidence)
    half = np.maximum(told[: len(names)], [wide.get(name, 0.0) for name in names])
    quantile = float(norm.isf(0.5 * (1.0 - confidence)))
    sd = half / quantile
    own = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    grown = np.maximum(sd / own, 1.0)
    covariance = fit.covariance * np.outer(grown, grown)
    return replace(fit, covariance=covariance, told=told / quantile)


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
        after=tuple(after),
    )
