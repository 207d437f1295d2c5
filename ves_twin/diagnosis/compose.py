"""compose: the verdict's fields from what was computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from ves_twin.diagnosis.adequacy import cells
from ves_twin.diagnosis.assess import Assessment
from ves_twin.diagnosis.explain import Explanation
from ves_twin.diagnosis.findable import findable_sizes, twins
from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.gain import Gain
from ves_twin.diagnosis.leftover import Leftover, describe
from ves_twin.diagnosis.null import Thresholds
from ves_twin.diagnosis.observe import Observed
from ves_twin.diagnosis.refine import Fit, bare_residual
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import (
    Basis,
    Cause,
    ChannelError,
    Estimate,
    Findable,
    Kind,
    Proposal,
    Statistics,
    Verdict,
)
from ves_twin.types import FloatArray, SingleArray


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
        proposals: next programmes.
    """

    seen: Observed
    first: Assessment
    limits: Thresholds
    settings: Settings
    kappa: float
    scale: float | None
    found: Explanation | None = None
    gain: Gain | None = None
    proposals: tuple[Proposal, ...] = ()


def compose(
    findings: Findings, kind: Kind, basis: Basis, excluded: tuple[str, ...] = ()
) -> Verdict:
    """The verdict; causes only where the kind names some."""
    first, found, limits = findings.first, findings.found, findings.limits
    named = found is not None and kind not in (Kind.NOTHING, Kind.UNKNOWN)
    causes, alternatives = _causes(findings, found) if named and found else ((), ())
    sizes = findable_sizes(first.screen, limits.effect)
    units = {h.label: _unit(findings, h) for h in first.screen.bank.hypotheses}
    suspect = "" if found is None or named else _label(found.best)
    statistics = Statistics(
        effect=first.score,
        effect_threshold=limits.effect,
        misfit=first.misfit,
        misfit_threshold=limits.misfit,
        misfit_after=found.score if found else None,
        second_effect=found.second if found else None,
        naming_limit=findings.kappa,
        tolerance_scale=findings.scale,
    )
    return Verdict(
        verdict=kind,
        basis=basis,
        statistics=statistics,
        causes=causes,
        alternatives=alternatives,
        residuals=_residuals(findings),
        gain=findings.gain,
        leftover=None if kind is Kind.NOTHING else _leftover(findings),
        suspect=suspect,
        smallest_findable={label: Findable(v, units[label]) for label, v in sizes.items()},
        twins=tuple(twins(first.screen)),
        next_experiment=findings.proposals,
        unseen=findings.seen.unseen,
        excluded=excluded,
    )


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
    """Firm if it is no commissioning parameter, or further off than commissioning errors go."""
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
            sigmas.append(abs(size) / parameter.sd)
    absent = len(sigmas) < len(hypothesis.parameters)
    return Cause(
        effect=hypothesis.effect,
        target=hypothesis.target,
        parameters=estimates,
        probability=weight,
        firm=absent or max(sigmas) >= findings.kappa,
        sigmas=max(sigmas, default=None),
    )


def _residuals(findings: Findings) -> dict[str, ChannelError]:
    """Before: the model as it is. After: with commissioning errors, and the causes, fitted."""
    runs, measured = findings.seen.runs, findings.seen.measured
    plain = measured - findings.first.screen.bank.base.prediction
    found, first = findings.found, findings.first
    whitening = found.evidence.whitening if found else first.evidence.whitening
    before = whitening.apply(plain)
    if found:
        after, bare = found.best.residual, bare_residual(found.evidence, found.best)
    elif first.commissioning:
        after = first.commissioning.residual
        bare = bare_residual(first.evidence, first.commissioning)
    else:
        after = first.left
        columns = first.screen.bank.base.columns
        nuisances = first.screen.metric.nuisances(first.z)
        bare = plain - np.tensordot(nuisances.astype(np.float32), columns, axes=1)
    sigma = [_rms(np.concatenate(whitening.blocks(z))) for z in (before, after)]
    unit = [_rms(plain), _rms(bare)]
    channels = [runs.forward.channels[c] for c in runs.columns]
    return {
        channel.name: ChannelError(
            float(sigma[0][c]),
            float(sigma[1][c]),
            float(unit[0][c]),
            float(unit[1][c]),
            channel.unit,
        )
        for c, channel in enumerate(channels)
    }


def _rms(rows: FloatArray | SingleArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(np.square(rows, dtype=float), axis=0)))


def _leftover(findings: Findings) -> Leftover:
    found, first = findings.found, findings.first
    limit = findings.limits.misfit
    if found:
        return describe(found.evidence, found.best.residual, found.after, limit)
    fit = first.commissioning
    residual = first.left if fit is None else fit.residual
    return describe(first.evidence, residual, cells(first.evidence.whitening, residual), limit)
