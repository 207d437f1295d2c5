"""NullDistribution: what the statistics do on rigs with nothing wrong but commissioning errors."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from ves_twin.diagnosis.adequacy import cells, misfit, misfit_floor
from ves_twin.diagnosis.bank import Bank, bank_key, write_arrays
from ves_twin.diagnosis.refine import Evidence, Fit, bare_residual, refine, residual_about
from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.screen import Screen, Suspect
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.whitening import Whitening
from ves_twin.types import FloatArray, SingleArray

DECLARED = ((0.9, 1.12), (0.0, 0.25))
"""Ranges that a null rig's noise is drawn from: sd against the noise model's, lag-one colour."""

MEASURED = ((0.95, 1.05), (-0.05, 0.05))
"""The same where a standstill recording told the noise."""

ROUNDS = 3
"""Linearisations at most for the commissioning errors of one record."""

TAIL_FROM = 0.75
"""Share of the sample below the tail that is extrapolated."""


@dataclass(frozen=True)
class Thresholds:
    """Levels that a rig with nothing wrong passes with probability alpha each.

    Attributes:
        effect: of the best hypothesis's chi^2.
        misfit: of the largest cell score.
        effects, misfits: the null samples they come from.
    """

    effect: float
    misfit: float
    effects: FloatArray
    misfits: FloatArray


@dataclass(frozen=True)
class Assessment:
    """A record before any cause is fitted.

    Attributes:
        evidence: with the whitening as the record itself has it.
        screen: the bank under that whitening.
        z: whitened residual about the bank's base (samples,).
        left: z less what the nuisances explain.
        suspects: hypotheses by falling score.
        misfit: largest cell score.
        commissioning: fit of commissioning errors alone; None while it was not needed.
    """

    evidence: Evidence
    screen: Screen
    z: FloatArray
    left: FloatArray
    suspects: list[Suspect]
    misfit: float
    commissioning: Fit | None

    @property
    def score(self) -> float:
        """The best hypothesis's chi^2."""
        return self.suspects[0].score if self.suspects else 0.0

    @property
    def pull(self) -> float:
        """Largest most probable commissioning error, in declared sd (the step's share is none)."""
        errors = self.screen.metric.nuisances(self.z)[: len(self.evidence.runs.nuisances)]
        return float(np.max(np.abs(errors), initial=0.0))

    def exceeds(self, effect: float, misfit: float, pull: float) -> bool:
        """Whether something is there."""
        return self.score > effect or self.misfit > misfit or self.pull > pull


def assess(
    measured: SingleArray,
    bank: Bank,
    whitening: Whitening,
    effect: float,
    level: float,
    pull: float,
) -> Assessment:
    """Screen a record; where it looks faulty, once more with the nuisances fitted in full.

    Args:
        measured: channels on the grid (rows, c).
        bank: the library's signatures.
        whitening: noise as declared or measured.
        effect: score that leads to the second look.
        level: misfit that leads to it.
        pull: commissioning error [sd] that leads to it.
    """
    runs = bank.base.runs
    raw = whitening.apply(measured - bank.base.prediction)
    plain = Screen(bank, whitening)
    own = whitening.adapted(plain.metric.project(raw))
    first = _look(Evidence(runs, measured, own), Screen(bank, own), None)
    if not first.exceeds(effect, level, pull):
        return first
    look = first
    for rounds in (0, ROUNDS):
        evidence = look.evidence
        start = runs.origin if look.commissioning is None else look.commissioning.shift
        fit = refine(evidence, (), start, bank.base, rounds)
        own = whitening.adapted(whitening.apply(bare_residual(evidence, fit)))
        look = _look(Evidence(runs, measured, own), Screen(bank, own), fit)
        if not look.exceeds(effect, level, pull):
            break
    return look


def _look(evidence: Evidence, screen: Screen, fit: Fit | None) -> Assessment:
    base = screen.bank.base
    if fit is None:
        z = evidence.whitening.apply(evidence.measured - base.prediction)
    else:
        z = residual_about(evidence, fit, base)
    left = screen.metric.project(z)
    worst = misfit(cells(evidence.whitening, left))
    return Assessment(evidence, screen, z, left, screen.suspects(z), worst, fit)


def pull_limit(bank: Bank, alpha: float) -> float:
    """Declared sd that the largest commissioning error of a rig in order passes with alpha.

    It catches what the library lacks and the commissioning parameters would swallow: a cause that
    was left out, or a tolerance that is wrong.
    """
    return float(norm.isf(alpha / (2.0 * max(len(bank.base.runs.nuisances), 1))))


def null_thresholds(
    bank: Bank,
    whitening: Whitening,
    count: int,
    alpha: float,
    seed: int = 0,
    progress: Progress = silent,
) -> Thresholds:
    """Thresholds by parametric bootstrap: rigs drawn within their commissioning tolerances.

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
    """
    library = max(len(bank.hypotheses), 1)
    floor = float(chi2.isf(alpha / library, 1))
    samples = len(whitening.apply(bank.base.prediction))
    floor_misfit = misfit_floor(len(cells(whitening, np.zeros(samples))), alpha)
    study = _NullStudy(bank, whitening, floor, floor_misfit, alpha)
    seeds = np.random.SeedSequence(seed).spawn(count)
    drawn = np.array(list(_draws(study, seeds, progress)))
    return Thresholds(
        max(floor, _tail(drawn[:, 0], alpha)),
        max(floor_misfit, _tail(drawn[:, 1], alpha)),
        drawn[:, 0],
        drawn[:, 1],
    )


@dataclass(frozen=True)
class _NullStudy:
    """What one null rig is drawn from and judged by."""

    bank: Bank
    whitening: Whitening
    effect: float
    misfit: float
    alpha: float

    def draw(self, seed: np.random.SeedSequence) -> tuple[float, float]:
        runs, rng = self.bank.base.runs, np.random.default_rng(seed)
        shift = runs.origin
        spread = runs.sd[runs.nuisances]
        shift[runs.nuisances] = spread * rng.standard_normal(len(spread))
        clean = runs.one(np.clip(shift, runs.low, runs.high), refined=bool(rng.integers(2)))
        levels, colours = MEASURED if self.whitening.measured else DECLARED
        noise = self.whitening.draw(rng, rng.uniform(*levels), rng.uniform(*colours))
        limit = pull_limit(self.bank, self.alpha)
        found = assess(clean + noise, self.bank, self.whitening, self.effect, self.misfit, limit)
        return found.score, found.misfit

    def batch(self, seeds: list[np.random.SeedSequence]) -> list[tuple[float, float]]:
        return [self.draw(seed) for seed in seeds]


def _draws(
    study: _NullStudy, seeds: list[np.random.SeedSequence], progress: Progress
) -> Iterator[tuple[float, float]]:
    """Statistics of each null rig; the same whatever the number of processes."""
    workers = study.bank.base.runs.workers
    if workers == 1:
        for i, seed in enumerate(seeds):
            progress(i / len(seeds), "null distribution")
            yield study.draw(seed)
        return
    # few batches: each carries the whole bank to its process
    batches = [seeds[i :: 2 * workers] for i in range(2 * workers)]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        for i, batch in enumerate(pool.map(study.batch, batches)):
            progress((i + 1) / len(batches), "null distribution")
            yield from batch


def cached_thresholds(
    bank: Bank, whitening: Whitening, settings: Settings, progress: Progress = silent
) -> Thresholds:
    """The thresholds from a file beside the bank's, computed and written where there is none.

    Raises:
        FileAccessError: the folder cannot be written.
    """

    def compute() -> Thresholds:
        return null_thresholds(
            bank, whitening, settings.nulls, settings.alpha, settings.seed, progress
        )

    if settings.cache is None:
        return compute()
    labels = [h.label for h in bank.hypotheses]
    content = repr((labels, settings.nulls, settings.alpha, settings.seed)).encode()
    content += whitening.filters.tobytes() + whitening.mixing.tobytes()
    path = settings.cache / f"null-{bank_key(bank.base.runs, content)}.npz"
    if path.is_file():
        with np.load(path) as kept:
            effect, level = float(kept["effect"]), float(kept["misfit"])
            return Thresholds(effect, level, kept["effects"], kept["misfits"])
    found = compute()
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
