"""design_excitation: a programme that tells given causes apart better than a menu does."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank
from ves_twin.diagnosis.bank.slices import of_time
from ves_twin.diagnosis.experiment.aliases import lookalikes
from ves_twin.diagnosis.experiment.findable import findable_sizes
from ves_twin.diagnosis.experiment.next_experiment import NUISANCES
from ves_twin.diagnosis.experiment.separation import Question, changes, separation, size_of
from ves_twin.diagnosis.experiment.trials import FORWARD_STEP, Trials
from ves_twin.diagnosis.fit.null import chance_floor
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings

SCHEMA = 1
"""Version of the design as JSON; fields are added without a new one."""

SCATTERED = 12
"""Points that are tried all over the box, by a Latin hypercube, before the best one is improved."""

EACH = 4
"""Points that are tried for each number of a point, from the best on."""

REACH = 0.3
"""First step of the search from the best point, the box being 2 wide."""

NOTHING = 30.0
"""Cost of a point that no machine bears: worse than any separation."""

PARTS = 20
"""Parts of its length after each of which a design is held against the menu's best."""


class DesignSpace(Protocol):
    """Programmes within a machine's limits, as points of the box [-1, 1]."""

    @property
    def size(self) -> int:
        """Numbers of a point."""

    def excitation(self, point: FloatArray, name: str) -> Excitation | None:
        """What is fed in at a point (size,); None if the nominal machine does not bear it."""


@dataclass(frozen=True)
class Judged:
    """What a programme tells of a question, by the whole simulation and all tolerances.

    Attributes:
        programme: its name.
        seconds: its length.
        sigma: separation of each pair at the sizes of `size_of`, the lesser of its two orders.
        told: size of each cause from which it is told from its rival, by pair (first, second);
            None where no size in its range is.
    """

    programme: str
    seconds: float
    sigma: tuple[float, ...]
    told: tuple[tuple[float | None, float | None], ...]

    @property
    def score(self) -> float:
        """One number of all pairs, see `score`."""
        return score(np.square(self.sigma))


@dataclass(frozen=True)
class Design:
    """A designed programme beside the best one of the menu.

    Attributes:
        excitation: that was designed.
        question: what it should tell apart.
        units: of the sizes of each of its causes.
        designed: what it tells.
        best: what the menu's best tells.
        begin: separation of each pair by the menu's best in the time of the design [sigma].
        after: time after which it tells as much as the menu's best in all of its own [s]; None if
            it never does.
        tried: programmes that were simulated.
    """

    excitation: Excitation
    question: Question
    units: tuple[str, ...]
    designed: Judged
    best: Judged
    begin: tuple[float, ...]
    after: float | None
    tried: int

    @property
    def times(self) -> float:
        """How many times as much it tells as the menu's best does in the same time [chi^2]."""
        return self.designed.score / max(score(np.square(self.begin)), 1e-12)

    def to_json(self) -> str:
        """The figures as JSON, without the rows of the programme."""
        causes = self.question.causes
        content = {
            "schema": SCHEMA,
            "pairs": [[causes[k].label for k in pair] for pair in self.question.pairs],
            "sizes": {c.label: size_of(c).tolist() for c in causes},
            "units": {c.label: unit for c, unit in zip(causes, self.units, strict=True)},
            "designed": asdict(self.designed),
            "best": asdict(self.best),
            "begin": self.begin,
            "times": self.times,
            "after": self.after,
            "tried": self.tried,
        }
        return json.dumps(content, indent=2, allow_nan=False)


def design_excitation(
    forward: Forward,
    question: Question,
    menu: Sequence[Excitation],
    space: DesignSpace,
    *,
    columns: Sequence[int] = (),
    settings: Settings,
    progress: Progress = silent,
) -> Design:
    """Optimise a programme for the separation of causes, and hold it against the menu's best.

    Of many tolerances the search takes those that count (`_counting`), by one-sided differences;
    what it finds is judged by all of them, by differences to both sides.

    Args:
        forward: the plant, its tolerances and its library.
        question: which causes.
        menu: programmes that it must beat.
        space: that it is looked for in.
        columns: numbers of the channels that would be recorded; all if none are given.
        settings: how sure, how many processes.
        progress: told what is being done.

    Raises:
        InvalidInputError: no point of the space is a programme that the nominal plant bears.
    """
    recorded = tuple(columns) or tuple(range(len(forward.channels)))
    with Workers(settings.workers) as workers:
        desk = _Desk(forward, question, recorded, workers, settings)
        trials = Trials(_counting(desk.runs(menu[0]), question, progress))
        values = []
        for k, one in enumerate(menu):
            progress(k / len(menu), "menu")
            values.append(desk.value(one, trials))
        best = menu[int(np.argmax(values))]
        found, tried = _climbed(desk, trials, space, progress)
        usual, known = desk.judged(best, progress)
        designed, bank = desk.judged(found, progress)
        after = _after(bank, question, usual.score)
        begin = _sigmas(known, question, designed.seconds)
    said = {parameter.name: parameter.unit for parameter in forward.parameters}
    units = tuple(said[cause.parameters[0]] for cause in question.causes)
    return Design(found, question, units, designed, usual, begin, after, tried)


def score(chi2: FloatArray) -> float:
    """One separation [chi^2] for those of all pairs: 1 + it is the geometric mean of theirs.

    A pair that is hardly parted counts more than one that is parted well, and one that no
    programme parts does not hide the others.
    """
    return float(np.expm1(np.mean(np.log1p(chi2))))


@dataclass(frozen=True)
class _Desk:
    """What programmes are judged with."""

    forward: Forward
    question: Question
    columns: tuple[int, ...]
    workers: Workers
    settings: Settings

    def runs(self, programme: Excitation) -> Runs:
        """Of one programme."""
        return Runs(self.forward, (programme,), self.columns, self.workers)

    def value(self, programme: Excitation, trials: Trials) -> float:
        """Score by few runs; zero where the plant fails."""
        base, axes = trials.at(self.runs(programme))
        chi2 = self.question.least(separation(base, self.question, axes))
        return score(chi2) if np.all(np.isfinite(chi2)) else 0.0

    def judged(self, programme: Excitation, progress: Progress) -> tuple[Judged, SignatureLibrary]:
        """By differences to both sides, all tolerances, and the sizes of a plan; with its bank."""
        runs, causes = self.runs(programme), self.question.causes
        base = linearise(runs, runs.origin, progress)
        chi2 = self.question.least(separation(base, self.question))
        bank = build_bank(runs, hypotheses=causes, base=base, sparse=self.settings.sparse)
        screen = Screen(bank, whitening_declared(runs))
        count = len(self.forward.hypotheses)
        sizes = findable_sizes(screen, chance_floor(count, self.settings.alpha))
        pairs = lookalikes(screen, sizes, self.settings.odds, self.settings.model_error)
        alike = {(pair.cause, pair.other): pair.beyond for pair in pairs}
        labels = [cause.label for cause in causes]

        def told(i: int, j: int) -> float | None:
            pair = labels[i], labels[j]
            return alike[pair] if pair in alike else sizes[labels[i]]

        judged = Judged(
            programme.name,
            float(programme.time[-1] - programme.time[0]),
            tuple(float(value) for value in np.sqrt(chi2)),
            tuple((told(i, j), told(j, i)) for i, j in self.question.pairs),
        )
        return judged, bank


def _climbed(
    desk: _Desk, trials: Trials, space: DesignSpace, progress: Progress
) -> tuple[Excitation, int]:
    """The best programme of a space that is found, and how many were tried.

    Scattered points first; then from the best one on, by linear models of the cost, which need
    the fewest runs for each number of a point.
    """
    tried: list[tuple[float, FloatArray]] = []

    def cost(point: FloatArray) -> float:
        inside = np.clip(point, -1.0, 1.0)
        progress(min(len(tried) / (SCATTERED + EACH * space.size), 1.0), "design")
        made = space.excitation(inside, "design")
        value = 0.0 if made is None else desk.value(made, trials)
        tried.append((value, inside))
        return -float(np.log(value)) if value > 0.0 else NOTHING

    scattered = 2.0 * qmc.LatinHypercube(space.size, rng=0).random(SCATTERED) - 1.0
    first = min(scattered, key=cost)
    options = {"maxiter": EACH * space.size, "rhobeg": REACH, "tol": 0.05 * REACH}
    box = [(-1.0, 1.0)] * space.size
    minimize(cost, first, method="COBYLA", bounds=box, options=options)
    value, best = max(tried, key=lambda one: one[0])
    found = space.excitation(best, "designed")
    if found is None or value == 0.0:
        came = "no programme that keeps the machine's limits and tells anything"
        raise InvalidInputError("design", came, "typical sizes and ranges that leave room")
    return found, len(tried)


def _counting(runs: Runs, question: Question, progress: Progress) -> tuple[str, ...] | None:
    """Tolerances of the plant that could stand for the difference of a pair; None for all.

    Each costs a run of every programme: of many, those that make up most of the difference.
    """
    own = {name for cause in question.causes for name in cause.parameters}
    axes = [runs.coordinates[i] for i in runs.nuisances]
    names = [axis.parameter.name for axis in axes]
    plain = [axis.recording == -1 and not axis.parameter.additive for axis in axes]
    if sum(plain) <= NUISANCES:
        return None
    base = linearise(runs, runs.origin, progress, forward_step=FORWARD_STEP)
    white = changes(base, question)
    metric = Metric(whitening_declared(runs).apply(base.columns).T)
    gram = white.T @ metric.project(white)
    sizes = np.linalg.norm(metric.columns[:, :-1], axis=0)
    share = np.zeros(len(names))
    for i, j in question.pairs:
        rest = white[:, i] - gram[i, j] / max(gram[j, j], 1e-12) * white[:, j]
        share = np.maximum(share, np.abs(metric.nuisances(rest)[:-1]) * sizes)
    ranked = [n for n in np.argsort(-share) if plain[n] and names[n] not in own][:NUISANCES]
    return tuple(name for n, name in enumerate(names) if n in ranked or not plain[n] or name in own)


def _after(bank: SignatureLibrary, question: Question, goal: float) -> float | None:
    """Time from which the begin of a programme has a score."""
    time = bank.base.runs.programmes[0].time
    for part in np.arange(3, PARTS + 1) / PARTS:
        seconds = float(part * (time[-1] - time[0]))
        if score(np.square(_sigmas(bank, question, seconds))) >= goal:
            return seconds
    return None


def _sigmas(bank: SignatureLibrary, question: Question, seconds: float) -> tuple[float, ...]:
    """Separation of each pair by the first seconds of a programme."""
    chi2 = question.least(separation(of_time(bank, seconds).base, question))
    return tuple(float(value) for value in np.sqrt(chi2))
