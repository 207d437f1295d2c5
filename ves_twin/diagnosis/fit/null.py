"""NullDistribution: what the statistics do on rigs with nothing wrong but commissioning errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import numpy as np
from scipy.stats import chi2

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.linearise import STEP_SD
from ves_twin.diagnosis.bank.prewhitened import Prewhitened
from ves_twin.diagnosis.bank.signature_library import (
    SignatureLibrary,
    bank_key,
    read_arrays,
    write_arrays,
)
from ves_twin.diagnosis.fit.assess import assess, first_look, pull_limit
from ves_twin.diagnosis.record.adequacy import cells, misfit_floor
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.record.whitening import Whitening
from ves_twin.diagnosis.settings import Settings

DECLARED = ((0.9, 1.12), (0.0, 0.25))
"""Ranges that a null rig's noise is drawn from: sd against the noise model's, lag-one colour."""

MEASURED = ((0.95, 1.05), (-0.05, 0.05))
"""The same where a standstill recording told the noise."""

BENDS = 2e-3
"""What three linearisations leave of commissioning errors of a thousand sigma, relatively: seen on
rigs of VES II in order. Null rigs from a linearisation lack it."""

AFFORDABLE = 0.1
"""Share of the time of a diagnosis that simulated rigs may take: thresholds of linear ones are the
same but for BENDS."""

FEW = 3
"""Rigs that tell what one takes: one alone may be quick by chance."""

LEAST = 20
"""Linear rigs that are drawn however long one takes: five of them tell the tail."""

LINEAR = "simulated rigs in order (thresholds are of linear ones)"
"""What is left out where they would take too long."""

TAIL_FROM = 0.75
"""Share of the sample below the tail that is extrapolated."""


@dataclass(frozen=True)
class Thresholds:
    """Levels that a rig with nothing wrong passes with probability alpha each.

    Attributes:
        effect: of the best hypothesis's chi^2.
        misfit: of the largest cell score.
        effects, misfits: the null samples they come from.
        bends: relative error of what fitted commissioning errors explain; simulated rigs have it.
        in_order: largest cell score of simulated rigs in order: the level, or the median of the few
            that there was time for; None where none was simulated.
    """

    effect: float
    misfit: float
    effects: FloatArray
    misfits: FloatArray
    bends: float = 0.0
    in_order: float | None = None


def noise_floor(bank: SignatureLibrary, alpha: float) -> float:
    """chi^2 of the best of a bank's independent hypotheses that white noise passes with alpha."""
    return chance_floor(len(bank.hypotheses), alpha)


def chance_floor(count: int, alpha: float) -> float:
    """chi^2 of the best of so many independent causes that white noise passes with alpha."""
    return float(chi2.isf(alpha / max(count, 1), 1))


def noise_thresholds(bank: SignatureLibrary, whitening: Whitening, alpha: float) -> Thresholds:
    """Levels that white noise passes with probability alpha, commissioning errors known well."""
    samples = len(whitening.apply(bank.base.prediction))
    count, none = len(cells(whitening, np.zeros(samples))), np.zeros(0)
    return Thresholds(noise_floor(bank, alpha), misfit_floor(count, alpha), none, none)


def null_thresholds(
    bank: SignatureLibrary,
    whitening: Whitening,
    count: int,
    alpha: float,
    seed: int = 0,
    progress: Progress = silent,
    simulated: bool = True,
) -> Thresholds:
    """Thresholds by parametric bootstrap: rigs drawn within their commissioning tolerances.

    A simulated rig is fitted like a record. One drawn from the linearisation needs no run and no
    fit: it is what a simulated one comes to once its commissioning errors are fitted well.

    Each null rig has nuisances from their priors, half of them half the integration step, and
    noise of another level and colour. The tail above the sample's TAIL_FROM quantile u is taken as
    exponential: T(alpha) = u + mean excess * ln((1 - TAIL_FROM) / alpha). The threshold is never
    below that of white noise with independent hypotheses.

    Args:
        bank: the library's signatures.
        whitening: noise as declared or measured.
        count: null rigs.
        alpha: probability of passing each threshold with nothing wrong.
        seed: of the draws.
        progress: told how far it is.
        simulated: rigs by the forward; else by its linearisation.
    """
    floor = noise_thresholds(bank, whitening, alpha)
    study = _NullStudy(bank, whitening, floor.effect, floor.misfit, alpha, simulated)
    seeds = np.random.SeedSequence(seed).spawn(count)
    found = _in_time(study, seeds, progress) if simulated else []
    few, simulated = [misfit for _, misfit in found], len(found) == count
    if not simulated:
        found = _linear_in_time(replace(study, simulated=False), seeds, progress)
    drawn = np.array(found)
    level = max(floor.misfit, _tail(drawn[:, 1], alpha))
    some = float(np.median(few)) if few else None
    return Thresholds(
        max(floor.effect, _tail(drawn[:, 0], alpha)),
        level,
        drawn[:, 0],
        drawn[:, 1],
        0.0 if simulated else BENDS,
        level if simulated else some,
    )


@dataclass(frozen=True)
class _NullStudy:
    """What one null rig is drawn from and judged by; none begins beyond a share of the time.

    That share is `until`; None: all are drawn, however late it is.
    """

    bank: SignatureLibrary
    whitening: Whitening
    effect: float
    misfit: float
    alpha: float
    simulated: bool
    until: float | None = None

    def draw(self, seed: np.random.SeedSequence) -> tuple[float, float]:
        runs, rng = self.bank.base.runs, np.random.default_rng(seed)
        shift = runs.origin
        spread = runs.sd[runs.nuisances]
        shift[runs.nuisances] = spread * rng.standard_normal(len(spread))
        shift, refined = np.clip(shift, runs.low, runs.high), bool(rng.integers(2))
        clean = runs.one(shift, refined) if self.simulated else self._linear(shift, refined)
        levels, colours = MEASURED if self.whitening.measured else DECLARED
        noise = self.whitening.draw(rng, rng.uniform(*levels), rng.uniform(*colours))
        if not self.simulated:
            found = first_look(clean + noise, self._shaped)
            return found.score, found.misfit
        limit = pull_limit(self.bank, self.alpha)
        found = assess(clean + noise, self.bank, self.whitening, self.effect, self.misfit, limit)
        return found.score, found.misfit

    @cached_property
    def _shaped(self) -> Prewhitened:
        return Prewhitened(self.bank, self.whitening)

    def _linear(self, shift: FloatArray, refined: bool) -> SingleArray:
        base = self.bank.base
        share = shift[base.runs.nuisances] / base.runs.sd[base.runs.nuisances]
        share = np.append(share, refined / STEP_SD).astype(np.float32)
        return np.asarray(base.prediction + np.tensordot(share, base.columns, axes=1))

    def batch(self, seeds: list[np.random.SeedSequence]) -> list[tuple[float, float]]:
        budget = self.bank.base.runs.budget
        until = self.until
        return [self.draw(seed) for seed in seeds if until is None or budget.spent < until]


def _in_time(
    study: _NullStudy, seeds: list[np.random.SeedSequence], progress: Progress
) -> list[tuple[float, float]]:
    """Simulated rigs; the first ones where all would take more than AFFORDABLE of the time.

    The first FEW tell: batches of several processes come back when most of the time is gone.
    """
    budget, workers = study.bank.base.runs.budget, study.bank.base.runs.workers
    begun, drawn = budget.spent, list[tuple[float, float]]()
    study = replace(study, until=begun + AFFORDABLE)
    progress(0.0, "null distribution")
    first = ((one, workers.count) for seed in seeds[:FEW] for one in study.batch([seed]))
    rest = ((one, 1) for one in _draws(study, seeds[FEW:], progress))
    for one, share in chain(first, rest):
        drawn.append(one)
        if (budget.spent - begun) * len(seeds) > AFFORDABLE * share * len(drawn):
            break
    if len(drawn) < len(seeds):
        budget.leave_out(LINEAR)
    return drawn


def _linear_in_time(
    study: _NullStudy, seeds: list[np.random.SeedSequence], progress: Progress
) -> list[tuple[float, float]]:
    """Linear rigs; LEAST of them, and more within AFFORDABLE of the time."""
    found = list(_draws(study, seeds[:LEAST], progress))
    study = replace(study, until=study.bank.base.runs.budget.spent + AFFORDABLE)
    return [*found, *_draws(study, seeds[LEAST:], progress)]


def _draws(
    study: _NullStudy, seeds: list[np.random.SeedSequence], progress: Progress
) -> Iterator[tuple[float, float]]:
    """Statistics of each null rig; the same whatever the number of processes."""
    workers = study.bank.base.runs.workers
    # few batches: each carries the whole bank to its process
    count = len(seeds) if workers.count == 1 else 4 * workers.count
    batches = [seeds[i::count] for i in range(min(count, len(seeds)))]
    for i, batch in enumerate(workers.map(study.batch, batches)):
        progress((i + 1) / len(batches), "null distribution")
        yield from batch


def cached_thresholds(
    bank: SignatureLibrary, whitening: Whitening, settings: Settings, progress: Progress = silent
) -> Thresholds:
    """The thresholds from a file beside the bank's, computed and written where there is none.

    Raises:
        FileAccessError: the folder cannot be written.
    """

    def compute() -> Thresholds:
        return null_thresholds(
            bank,
            whitening,
            settings.nulls,
            settings.alpha,
            settings.seed,
            progress,
            settings.simulated_nulls,
        )

    if settings.cache is None:
        return compute()
    labels = [h.label for h in bank.hypotheses]
    asked = (settings.nulls, settings.simulated_nulls, settings.alpha, settings.seed)
    content = repr((labels, *asked)).encode()
    content += whitening.filters.tobytes() + whitening.mixing.tobytes()
    content += b"".join(bad.tobytes() for bad in bank.base.runs.holes if bad.any())
    content += bank.base.prediction.tobytes()  # as stored: another one where the code has changed
    path = settings.cache / f"null-{bank_key(bank.base.runs, content)}.npz"
    kept = read_arrays(path)
    if kept is not None:
        effect, level = float(kept["effect"]), float(kept["misfit"])
        linear = not settings.simulated_nulls
        told = (BENDS, None) if linear else (0.0, level)
        return Thresholds(effect, level, kept["effects"], kept["misfits"], *told)
    found = compute()
    if (settings.simulated_nulls and found.bends) or len(found.effects) < settings.nulls:
        return found  # another day may have the time
    write_arrays(
        path,
        effect=np.array(found.effect),
        misfit=np.array(found.misfit),
        effects=found.effects,
        misfits=found.misfits,
    )
    return found


def _tail(sample: FloatArray, alpha: float) -> float:
    start = float(np.quantile(sample, TAIL_FROM))
    excess = float(np.mean(sample[sample > start] - start))
    return start + excess * float(np.log((1.0 - TAIL_FROM) / alpha))
