"""assemble_verdict: the verdict's fields from what was computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.build_up.result import BuildUp, is_sublinear
from ves_twin.diagnosis.build_up.sizes import half_widths
from ves_twin.diagnosis.experiment.aliases import Lookalike, lookalikes
from ves_twin.diagnosis.experiment.findable import findable_sizes, twins
from ves_twin.diagnosis.explain.disagreement import Alone
from ves_twin.diagnosis.explain.rivals import rivals_of
from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.diagnosis.law.shaken import none_beside, shaken
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.adequacy import cells
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.residual_structure import ResidualStructure, describe
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.driving import driving
from ves_twin.diagnosis.verdict.report_traces import ReportTraces, exhibit_of
from ves_twin.diagnosis.verdict.sized import is_below_row, is_dead, is_ended, sized
from ves_twin.diagnosis.verdict.verdict import (
    Basis,
    ChannelError,
    Findable,
    Kind,
    Proposal,
    Statistics,
    Verdict,
)


@dataclass(frozen=True)
class Findings:
    """Everything a verdict is made from.

    Attributes:
        seen: the record and its runs.
        first: the record before any cause.
        limits: what noise and commissioning errors do.
        settings: how sure.
        kappa: declared sd beyond which a departure is a fault.
        scale: of the tolerances, None if not measured.
        found: the explanation; None if nothing is wrong or nothing fits.
        gain: on held-out recordings.
        forecast: ahead in time, of causes that belong to a stretch of it.
        proposals: next programmes.
        apart: what each recording says alone.
        logged: whether a recording comes from a log, whose stamps nobody knows to a row.
        widened: factor on the declared commissioning sd in this view.
        differs: largest difference of the baseline's inputs, of their range; None without one.
        built: what building up proved.
        before: the model without a cause, within its tolerances; None where nothing was found.
        law: that was found where no cause explains the record; None if nobody looked.
        shown: what the report shows as fitted, if not `found`: a law that is claimed.
        beside: proved causes with a law that is claimed of what they leave, fitted together.
        twins: what nothing in the recordings tells from causes that are named, by their label.
    """

    seen: Dataset
    first: Assessment
    limits: Thresholds
    settings: Settings
    kappa: float
    scale: float | None
    logged: bool = False
    widened: float = 1.0
    differs: float | None = None
    found: Explanation | None = None
    gain: Gain | None = None
    forecast: Gain | None = None
    proposals: tuple[Proposal, ...] = ()
    apart: tuple[Alone, ...] = ()
    built: BuildUp | None = None
    before: Fit | None = None
    law: LawFinding | None = None
    shown: Explanation | None = None
    beside: Explanation | None = None
    twins: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def fitted(self) -> Explanation | None:
        """What tuned numbers and residuals are of."""
        return self.shown or self.found


def assemble_verdict(
    findings: Findings, kind: Kind, basis: Basis, excluded: tuple[str, ...] = ()
) -> Verdict:
    """The verdict; causes only where the kind names some."""
    first, found, limits = findings.first, findings.found, findings.limits
    named = found is not None and kind.names_causes
    causes, alternatives = _causes(findings, found) if named and found else ((), ())
    built = findings.built
    parameters = findings.seen.runs.forward.parameters
    ends = {p.name: (p.low, p.high) for p in parameters}
    components = {p.name for p in parameters if p.component}
    row = _row(findings.seen)
    proved = sized(built, causes, ends, row, components) if built and named else ()
    tuned = _tuned(findings)
    nominal = {p.name: p.nominal for p in parameters}
    none = (
        none_beside(proved, {n: (e.low, e.high) for n, e in tuned.items()}, nominal)
        if findings.beside
        else ()
    )
    proved = driving(shaken(proved, findings.law, none), nominal)
    firm = {one.label: one.firm for one in proved}
    causes = tuple(replace(c, firm=firm.get(f"{c.effect}@{c.target}", c.firm)) for c in causes)
    worse = findings.gain is not None and bool(findings.gain.worse)
    nearest = _causes(findings, found)[0] if found and not named and not worse else ()
    exhibit = exhibit_of(findings.seen, first, findings.fitted, findings.before)
    least = first.limit(limits.effect)
    sizes = findable_sizes(first.screen, least)
    units = {h.label: _unit(findings, h) for h in first.screen.bank.hypotheses}
    suspect = "" if found is None or named else _label(found.best)
    statistics = Statistics(
        effect=first.score,
        effect_threshold=least,
        misfit=first.misfit,
        misfit_threshold=limits.misfit,
        misfit_after=found.score if found else None,
        second_effect=found.second if found else None,
        naming_limit=findings.kappa,
        tolerance_scale=findings.scale,
        naming_odds=findings.settings.odds,
        widened=findings.widened,
        misfit_in_order=limits.in_order,
    )
    verdict = Verdict(
        verdict=kind,
        basis=basis,
        statistics=statistics,
        causes=causes,
        alternatives=alternatives,
        residuals=_residuals(findings, exhibit),
        gain=findings.gain,
        forecast=findings.forecast,
        tuned=tuned,
        leftover=None if kind is Kind.NOTHING else _leftover(findings),
        suspect=suspect,
        rivals=rivals_of(first, found),
        smallest_findable={label: Findable(v, units[label]) for label, v in sizes.items()},
        twins=tuple(twins(first.screen)),
        lookalikes=_lookalikes(findings, causes, sizes),
        next_experiment=findings.proposals,
        unseen=findings.seen.unseen,
        holes=findings.seen.holes,
        excluded=excluded,
        alone=findings.apart,
        exhibit=exhibit,
        proved=proved,
        put_to_proof=built.tested if built else None,
        false_discovery_rate=built.false_discovery_rate if built else None,
        p_limit=built.p_limit if built else None,
        unproved=built.unproved if built else {},
        left=built.left if built else {},
        inseparable=built.inseparable if built else (),
        nearest=nearest,
        law=findings.law,
    )
    return _provisional(verdict) if verdict.unconfirmed else verdict


def _provisional(verdict: Verdict) -> Verdict:
    """No name is firm that held-out recordings could have confirmed and did not."""
    causes = tuple(replace(cause, firm=False) for cause in verdict.causes)
    return replace(
        verdict, causes=causes, proved=tuple(replace(one, firm=False) for one in verdict.proved)
    )


def _row(seen: Dataset) -> float:
    """The longest step between rows of the recordings [s]; poses have none."""
    clocked = [programme.time for programme in seen.runs.programmes if not programme.poses]
    return max((float(np.median(np.diff(time))) for time in clocked), default=0.0)


def _lookalikes(
    findings: Findings, causes: Sequence[Cause], sizes: dict[str, float | None]
) -> tuple[Lookalike, ...]:
    """What a named cause could be taken for in these recordings, and up to which size."""
    if not causes:
        return ()
    settings, names = findings.settings, {f"{cause.effect}@{cause.target}" for cause in causes}
    screen = findings.first.screen
    return tuple(lookalikes(screen, sizes, settings.odds, settings.model_error, names))


def _label(fit: Fit) -> str:
    return " with ".join(h.label for h in fit.causes)


def _unit(findings: Findings, hypothesis: Hypothesis) -> str:
    runs = findings.seen.runs
    return runs.coordinates[int(runs.indices(hypothesis)[0])].parameter.unit


def _causes(
    findings: Findings, found: Explanation
) -> tuple[tuple[Cause, ...], tuple[tuple[int, ...], ...]]:
    causes: list[Cause] = []
    alternatives = []
    for fit, weight in zip(found.chosen, found.weights, strict=True):
        numbers, start = [], 0
        for hypothesis in fit.causes:
            numbers.append(len(causes))
            causes.append(_cause(findings, fit, hypothesis, start, weight))
            start += len(hypothesis.parameters)
        alternatives.append(tuple(numbers))
    return tuple(causes), tuple(alternatives)


def _cause(
    findings: Findings, fit: Fit, hypothesis: Hypothesis, start: int, weight: float
) -> Cause:
    """Firm if it is no commissioning parameter, or further off than commissioning errors go.

    Not where every interval holds what the model has already: such a size may be none. Nor a size
    that an end of its range holds, nor a delay of less than a row of a log, nor what a reversal
    alone would tell from another cause, nor of a log what reads so of another friction.
    """
    runs = findings.seen.runs
    z = float(norm.isf(0.5 * (1.0 - findings.settings.confidence)))
    estimates, sigmas = {}, []
    for n, i in enumerate(runs.indices(hypothesis), start):
        parameter = runs.coordinates[int(i)].parameter
        size, sd = float(fit.sizes[n]), float(np.sqrt(fit.covariance[n, n]))
        value = parameter.nominal + size
        low, high = max(value - z * sd, parameter.low), min(value + z * sd, parameter.high)
        estimates[parameter.name] = Estimate(value, low, high, parameter.unit, parameter.nominal)
        if parameter.sd > 0.0:
            sigmas.append(findings.widened * abs(size) / parameter.sd)
    absent = len(sigmas) < len(hypothesis.parameters)
    shown = any(not e.low <= e.nominal <= e.high for e in estimates.values())
    row = _row(findings.seen) if findings.logged else 0.0
    below = any(is_below_row(name, e, row) for name, e in estimates.items())
    ends = {p.name: (p.low, p.high) for p in runs.forward.parameters}
    estimates = {
        name: replace(e, at_limit=is_ended(e, *ends[name]) and not is_dead(e))
        for name, e in estimates.items()
    }
    ended = any(e.at_limit for e in estimates.values())
    like = findings.twins.get(hypothesis.label, ())
    values = [one.value for one in estimates.values()]
    shown = shown and not (findings.logged and is_sublinear(hypothesis.effect, values))
    return Cause(
        effect=hypothesis.effect,
        target=hypothesis.target,
        parameters=estimates,
        probability=weight,
        firm=shown and not (below or ended or like) and (absent or max(sigmas) >= findings.kappa),
        sigmas=max(sigmas, default=None),
        below_row=below,
        acts_like=like,
        ended=ended,
    )


def _tuned(findings: Findings) -> dict[str, Estimate]:
    """Commissioning numbers of the plant at the best fit, with what is known of them then.

    Beside a law of what causes leave, sizes of the causes too: they were fitted together with it.
    Where the model leaves more than noise, its error counts as well.
    """
    fitted = findings.beside or findings.fitted
    fit = fitted.best if fitted else findings.first.commissioning
    if fit is None:
        return {}
    runs, confidence = fit.local.runs, findings.settings.confidence
    z = float(norm.isf(0.5 * (1.0 - confidence)))
    if fit.told is not None:
        half = z * fit.told
    elif fitted is not None and not fitted.adequate:
        half = half_widths(fitted.evidence, fit, confidence)
    else:
        half = z * np.sqrt(np.diag(fit.posterior))
    free, estimates = set(fit.active[: len(fit.sizes)]), {}
    for n, i in enumerate(fit.active):
        parameter = runs.coordinates[int(i)].parameter
        if i in free or runs.coordinates[int(i)].recording != -1:
            continue
        value, reach = parameter.nominal + float(fit.shift[i]), float(half[n])
        ends = value - reach, value + reach, parameter.unit, parameter.nominal
        pull = float(fit.shift[i]) / parameter.sd if parameter.sd > 0.0 else None
        estimates[parameter.name] = Estimate(value, *ends, i in fit.held, pull)
    return estimates


def _residuals(findings: Findings, exhibit: ReportTraces) -> dict[str, ChannelError]:
    """Before: the model as it is. After: with commissioning errors, and the causes, fitted."""
    found, fitted = {}, findings.fitted
    fit = fitted.best if fitted else findings.first.commissioning
    local = fit.local if fit else findings.first.screen.bank.base
    for c, channel in enumerate(exhibit.channels):
        traces = exhibit.traces
        found[channel.name] = ChannelError(
            before=_rms([t.before[:, c] for t in traces]),
            after=_rms([t.after[:, c] for t in traces]),
            before_si=_rms([t.measured[:, c] - t.nominal[:, c] for t in traces]),
            after_si=_rms([t.measured[:, c] - t.fitted[:, c] for t in traces]),
            unit=channel.unit,
            spread=_rms([t.measured[:, c] - np.nanmean(t.measured[:, c]) for t in traces]),
            tolerances_si=_rms([t.measured[:, c] - t.tolerances[:, c] for t in traces]),
            step_si=_rms([local.step_error[:, c]]),
        )
    return found


def _rms(pieces: Sequence[FloatArray | SingleArray]) -> float:
    return float(np.sqrt(np.nanmean(np.square(np.concatenate(pieces), dtype=float))))


def _leftover(findings: Findings) -> ResidualStructure:
    found, first = findings.fitted, findings.first
    limit = findings.limits.misfit
    if found:
        best = found.best
        return describe(found.evidence, best.prediction, best.residual, found.after, limit)
    fit, base = first.commissioning, first.screen.bank.base
    predicted, left = (
        (base.prediction, first.left) if fit is None else (fit.prediction, fit.residual)
    )
    return describe(first.evidence, predicted, left, cells(first.evidence.whitening, left), limit)
