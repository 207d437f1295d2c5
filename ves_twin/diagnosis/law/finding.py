"""law_finding: a search for laws as a finding: claim, held-out gain, band, what it rests on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.law.asked import HALF, Asked, asked_of_motion
from ves_twin.diagnosis.law.band import band_of_form
from ves_twin.diagnosis.law.candidate import Closed, Table
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.propose import Search
from ves_twin.diagnosis.law.result import LawFinding, LawNumber, LawRival
from ves_twin.diagnosis.law.rubbing import Rubbing
from ves_twin.diagnosis.law.screen import columns_about, values_of
from ves_twin.diagnosis.law.smoothness import best_of, projected
from ves_twin.diagnosis.model.law_forward import LawForward, Variable
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out import HeldOut
from ves_twin.effects.law import Law, LawShape, variable_along

SOURCE = "ves-twin diagnose"

GATE = 0.25
"""Share of the held-out excess that a law must take away."""

NO_WORSE = 0.02
"""Share by which rms errors on held-out recordings may grow over those of causes alone, in the mean
of all channels: a law of what they leave is there to predict better."""

NONE_WORSE = 0.1
"""The same for each channel: causes beside a law may not pay for it (a UR10e: one joint's error
halved, and of three others a fifth larger)."""

HELPS = 0.05
"""Share by which at least one channel's error must fall below that of causes alone: in units of a
noise that is declared too small a law is worth 600 nats that no channel shows (a measured arm)."""

WIDER = 1.3
"""Factor on a table's band: of 22 machines with shapes of ours the 90 % band as fitted held 81 % of
the knots."""

BAND = 0.90
"""Probability of bands and of intervals."""

DRAWN = 400
"""Draws of a table's numbers that make its band."""

PLOTTED = 61
"""Places of the band and, along time, of what the recordings ask for."""

TOLD = 8
"""Rivals that are told."""

INFORMED = 0.5
"""Share of its prior sd below which a point of the recordings says something."""


def law_finding(
    search: Search,
    held: HeldOut | None,
    progress: Progress = silent,
    causes: Mapping[str, float] | None = None,
) -> LawFinding:
    """What a search came to.

    Args:
        search: laws and their evidence.
        held: held-out recordings.
        progress: told what is being done.
        causes: rms error of each held-out channel [its unit] by causes beside which the law is,
            as they were proved without it.
    """
    best = search.best
    if best.candidate is None:
        raise TypeError("a search without laws")
    candidate = best.candidate
    law = replace(candidate.law(best.numbers), source=SOURCE)
    progress(0.0, "trying the law on held-out recordings")
    gain = _gain(search, held) if held else None
    progress(0.5, "the band of the law")
    asked = asked_of_motion(law, best, held.seen) if held else None
    reason = search.reason or (_gated(gain, causes or {}) if held else "") or refuted(asked)
    along = _along(search, law)
    drawn = law.shape is LawShape.TABLE or isinstance(candidate, Rubbing)
    return LawFinding(
        claimed=not reason,
        reason=reason,
        place=law.place,
        kind=law.kind.value,
        of=law.of,
        units=(*(v.unit for v in candidate.of), candidate.place.unit),
        shape=law.shape.value,
        form=law.form,
        numbers=_numbers(best),
        knots=law.knots,
        values=law.values,
        band=_band(search, along[0]) if drawn else (),
        seen=tuple((float(np.min(x)), float(np.max(x))) for x in along),
        points=_points(search, law, along) if law.shape is LawShape.TABLE else (),
        transient="time" in law.of,
        nats=search.nats,
        misfit=search.score(best),
        misfit_limit=search.limits.misfit,
        further=search.further - search.allowance(best),
        also=tuple(_rival(search, fit) for fit in search.pool[1 : TOLD + 1]),
        gain=gain,
    )


def _gated(gain: Gain | None, causes: Mapping[str, float]) -> str:
    """Why held-out recordings do not bear a law out; empty where they do."""
    if gain is None:
        return "the machine with it diverges on held-out recordings"
    if gain.share is None:
        return "the held-out recordings show nothing that it could improve"
    if gain.grown:
        return "the rms errors on held-out recordings grow with it"
    over_causes = {name: (rms, gain.errors[name][1]) for name, rms in causes.items() if rms > 0.0}
    grown = [np.log(after / before) for before, after in over_causes.values()]
    if grown and (np.mean(grown) > NO_WORSE or replace(gain, errors=over_causes).grown):
        return "the proved causes alone leave smaller rms errors on held-out recordings"
    if grown and max(grown) > NONE_WORSE:
        return "one channel is predicted worse with it than by the proved causes alone"
    if grown and min(grown) > np.log(1.0 - HELPS):
        return "no channel is predicted better with it by a twentieth than by the causes alone"
    if gain.share < GATE or gain.low is None or gain.low <= 0.0:
        return f"it takes only {100.0 * gain.share:.0f} % of the held-out excess away"
    return ""


def refuted(asked: Asked | None) -> str:
    """Why the motion itself speaks against the law; empty where it does not, or cannot tell."""
    if asked is None or asked.most > HALF:
        return ""
    share, sd = 100.0 * asked.share, 100.0 * asked.sd
    found = f"{share:.0f} % (+- {sd:.0f} %)"
    return f"inverse dynamics finds {found} of its effort in the held-out motion"


def _gain(search: Search, held: HeldOut) -> Gain | None:
    """On held-out recordings, over commissioning errors alone, held within what is credible."""
    none, best = search.none.fit, search.best
    if none.pull > search.limits.pull:
        none = refine(
            search.evidence,
            (),
            none.shift,
            none.local,
            0,
            none.step_share,
            farthest=search.limits.pull,
        )
    runs = replace(held.seen.runs, forward=best.fit.local.runs.forward)
    gain = replace(held, seen=replace(held.seen, runs=runs)).gain(none, best.fit)
    # a hold has no size that could be taken out again
    return gain if best.count or gain is None else replace(gain, without=None)


def _numbers(best: LawFit) -> tuple[LawNumber, ...]:
    """Of a law with a formula."""
    if best.candidate is None or best.candidate.kernels:
        return ()
    names = [f"number {n + 1}" for n in range(best.count)]
    if isinstance(best.candidate, Closed):
        names = []
        for form, inner in zip(best.candidate.forms, best.candidate.inner, strict=True):
            names += [f"factor of {form.formula}", *"pq"[: len(inner)]]
    reach = float(norm.isf(0.5 * (1.0 - BAND))) * WIDER
    sd = np.sqrt(np.diag(best.fit.covariance)) * reach
    values = best.numbers.tolist()
    return tuple(
        LawNumber(name, x, x - w, x + w)
        for name, x, w in zip(names, values, sd.tolist(), strict=True)
    )


def _rival(search: Search, fit: LawFit) -> LawRival:
    if fit.candidate is None:
        raise TypeError("a rival without a law")
    form = fit.candidate.law(fit.numbers).form
    behind = search.best.log_evidence - fit.log_evidence
    return LawRival(fit.candidate.label, form, behind, search.leaves_noise(fit))


@dataclass(frozen=True)
class _Trace(Table):
    """A table of time beside a law, which may be one of time too."""

    @property
    def label(self) -> str:
        return f"{super().label}: trace"


def _along(search: Search, law: Law) -> list[FloatArray]:
    """Each variable of a law (n,) along all recordings."""
    runs, plant = search.best.fit.local.runs, search.evidence.runs.forward
    if not isinstance(plant, LawForward):
        raise TypeError(f"{type(plant).__name__} has no places for laws")
    seen = [
        plant.visited(programme, values, [law])
        for programme, values in zip(
            runs.programmes, values_of(runs, search.best.fit.shift), strict=True
        )
    ]
    return [np.concatenate([variable_along(name, one) for one in seen]) for name in law.of]


def _band(search: Search, x: FloatArray) -> tuple[tuple[float, ...], ...]:
    """Places, and ends of the band of the law there."""
    best = search.best
    if best.candidate is None:
        return ()
    at = np.linspace(float(np.min(x)), float(np.max(x)), PLOTTED)
    if isinstance(best.candidate, Closed):
        ends = band_of_form(search.evidence, best, at, BAND)
    else:
        covariance = WIDER**2 * best.fit.covariance
        rng = np.random.default_rng(0)
        drawn = rng.multivariate_normal(best.numbers, covariance, DRAWN, method="eigh")
        fast = [best.candidate.fastest[1]] if isinstance(best.candidate, Rubbing) else []
        path = at, *(np.full(PLOTTED, speed) for speed in fast)
        rows = np.array([best.candidate.law(numbers).at(*path) for numbers in drawn])
        tail = 0.5 * (1.0 - BAND)
        ends = np.quantile(rows, [tail, 1.0 - tail], axis=0)
    return tuple(at.tolist()), tuple(ends[0].tolist()), tuple(ends[1].tolist())


def _points(search: Search, law: Law, along: list[FloatArray]) -> tuple[tuple[float, ...], ...]:
    """Variable, effort or reading that the recordings ask for, and its sd.

    What is at work is estimated along time, by a smooth prior and by no law: by the columns at the
    law's fit, from its residual plus what the law itself makes there. It is drawn against the
    law's variable, so that another law would show.
    """
    best, runs = search.best, search.evidence.runs
    if best.candidate is None or len(runs.programmes) > 1:
        return ()
    time = runs.programmes[0].time - runs.programmes[0].time[0]
    knots = np.linspace(0.0, float(time[-1]), PLOTTED)
    clock = _Trace(best.candidate.place, (Variable("time", "s"),), tuple(knots.tolist()))
    columns = columns_about(search.evidence, clock, best)
    at = np.interp(knots, time, along[0])
    others = best.jacobian[:, best.count :]
    z = best.fit.residual + columns @ law.at(at) + others @ best.point[best.count :]
    gram, slope = projected(columns, others, z, best.temper)
    smooth = best_of(gram, slope, clock)
    precision = gram + np.linalg.inv(smooth.size**2 * clock.kernels[smooth.length])
    covariance = np.linalg.inv(precision)
    value, sd = covariance @ slope, np.sqrt(np.diag(covariance))
    kept = sd < INFORMED * smooth.size
    return tuple(tuple(rows[kept].tolist()) for rows in (at, value, sd))
