"""prove: which chosen trials predict held-out rows better, each by itself, beside all others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray, IntArray
from ves_twin.diagnosis.build_up.discrepancy import apart, carried
from ves_twin.diagnosis.build_up.paired import Difference, loss, paired
from ves_twin.diagnosis.build_up.regression import Half, LinearFit, Regression
from ves_twin.diagnosis.metric import Metric
from ves_twin.diagnosis.whitening import Whitening

FALSE_SHARE = 0.05
"""False-discovery rate over everything that was put to proof."""

NULL_FROM = 0.5
"""p from which a trial counts as one that held-out rows do not speak for (Storey's lambda)."""

AGAIN = 0.5
"""Share of that rate at which a trial that was dropped may come back: dropping went one by one."""

STRAINED = 5.0
"""Sd beyond which a tolerance is not taken to do a cause's work, unless it is that far off beside
all that are in as well: columns of a gain hold what causes do, and 95 % less gain would stand for
all frictions of an axis (EMPS, as it is drafted)."""

ERRORS = ((True, False), (False, False), (False, True))
"""What is compared, (memory, even): one-step prediction errors or plain ones, scaled by the middle
or evenly, by their rms. Plain errors are large where a model is wrong: by the middle that counts
for little (oil that is a spring, where a cylinder's load changes: p of 0.5 for 0.03), by the rms
a double pendulum's link is lost. Squares of one-step errors lost TX40's coupling."""

ACTS = 0.05
"""Share of its strongest channel's part from which a trial counts as acting on a channel."""


@dataclass(frozen=True)
class Bench:
    """Fits of any subset of trials to the fitted half, told on the held-out half.

    Sizes are of the fitted half; what is drawn anew for each held-out recording is taken off there
    in every subset alike. The discrepancy is held, so that a trial that is taken out does not pass
    for more of it; channels are judged one by one.

    Attributes:
        fit: of all trials of the bench, on the fitted half.
        held: the held-out half.
        regression: of the fitted half.
        errors: which are compared, one of ERRORS.
    """

    fit: LinearFit
    held: Half
    regression: Regression
    errors: tuple[bool, bool] = ERRORS[0]

    @cached_property
    def own_colour(self) -> Whitening:
        """The discrepancy of each channel by itself, on the held-out half."""
        return apart(carried(self.fit.whitening, self.held.runs))

    @cached_property
    def _told(self) -> tuple[FloatArray, FloatArray]:
        """Held-out design (rows, c, k) and target (rows, c), whitened; own nuisances taken off."""
        held, width = self.held, len(self.held.runs.columns)
        whitening = self.own_colour
        columns = [held.shared, *held.columns.of(self.fit.chosen)]
        design = whitening.apply(np.concatenate(columns)).T
        scale = np.delete(self.fit.scale, self._own)
        both = np.column_stack([design * scale, whitening.apply(held.target.astype(np.float32))])
        if len(held.own):
            unit = np.repeat(self._unit[None], len(both) // width, axis=0).ravel()
            metric = Metric(whitening.apply(held.own).T / unit[:, None])
            both = metric.project(both / unit[:, None]) * unit[:, None]
        both = both.reshape(-1, width, both.shape[1])
        return both[..., :-1], both[..., -1]

    @cached_property
    def _own(self) -> IntArray:
        """Columns of the fit that belong to single fitted recordings."""
        first = len(self.regression.half.shared)
        return np.arange(first, first + len(self.regression.half.own))

    @cached_property
    def _unit(self) -> FloatArray:
        """Sd of the innovations of each channel on the fitted half (c,)."""
        whitening = apart(self.fit.whitening)
        width = len(self.held.runs.columns)
        inner = whitening.apply(self.fit.residual.astype(np.float32)).reshape(-1, width)
        count = whitening.freedom.reshape(-1, width).sum(axis=0)
        return np.asarray(np.sqrt(np.sum(inner**2, axis=0) / np.maximum(count, 1.0)) + 1e-30)

    @cached_property
    def whole(self) -> BoolArray:
        """Held-out samples that count (rows, c)."""
        return self.own_colour.freedom.reshape(-1, len(self.held.runs.columns)) > 0.0

    @cached_property
    def pieces(self) -> IntArray:
        """Number of the contiguous stretch of each held-out sample (rows,)."""
        any_kept = np.asarray(self.whole.any(axis=1))
        numbers: list[IntArray] = []
        start = 0
        for k, block in enumerate(self.own_colour.times()):
            rows = any_kept[start : start + len(block)]
            steps = np.cumsum(np.append(0, np.abs(np.diff(rows.astype(int)))))
            numbers.append(steps + (numbers[-1][-1] + 1 if k and len(numbers[-1]) else 0))
            start += len(block)
        return np.concatenate(numbers)

    @cached_property
    def places(self) -> dict[int, IntArray]:
        """Columns of each trial in the fit."""
        return self.regression.places(self.fit.chosen)

    def subset(
        self, trials: Sequence[int], of: Sequence[int] | None = None
    ) -> tuple[IntArray, FloatArray]:
        """Columns of a subset with all nuisances, and their amplitudes on the fitted half.

        Args:
            trials: the subset.
            of: a larger one beside which amplitudes are fitted; the subset itself if None.
        """
        first = len(self.regression.half.shared) + len(self.regression.half.own)
        parts = [np.arange(first), *(self.places[n] for n in (trials if of is None else of))]
        at = np.concatenate(parts).astype(int)
        shares = self._held(at, first)
        kept = np.concatenate([np.arange(first), *(self.places[n] for n in trials)]).astype(int)
        amplitude = np.zeros(len(self.fit.scale))
        amplitude[at] = shares
        return kept, amplitude[kept]

    def _held(self, at: IntArray, nuisances: int) -> FloatArray:
        """Amplitudes of columns, nuisances no farther off than in the bench's fit, or STRAINED."""
        limit = np.full(len(at), np.inf)
        limit[:nuisances] = np.maximum(STRAINED, np.abs(self.fit.shares[:nuisances]))
        matrix, slope = self.fit.hessian[np.ix_(at, at)], self.fit.gradient[at]
        shares, free = np.zeros(len(at)), np.ones(len(at), bool)
        while True:
            gradient = slope[free] - matrix[np.ix_(free, ~free)] @ shares[~free]
            shares[free] = np.linalg.solve(matrix[np.ix_(free, free)], gradient)
            beyond = free & (np.abs(shares) > limit)
            if not beyond.any():
                return shares
            shares[beyond] = np.sign(shares[beyond]) * limit[beyond]
            free &= ~beyond

    def innovations(self, trials: Sequence[int], of: Sequence[int] | None = None) -> FloatArray:
        """What a subset leaves of the held-out rows (rows, c); arguments as of `subset`."""
        at, shares = self.subset(trials, of)
        kept = ~np.isin(at, self._own)
        every = np.setdiff1d(np.arange(len(self.fit.scale)), self._own)
        design, target = self._told
        where = np.searchsorted(every, at[kept])
        return np.asarray(target - design[..., where] @ shares[kept])

    def residual(self, trials: Sequence[int]) -> FloatArray:
        """What a subset leaves of the held-out channels, in their units, own nuisances unfitted."""
        at, shares = self.subset(trials)
        amplitudes = np.zeros(len(self.fit.scale))
        amplitudes[at] = shares
        amplitudes = np.delete(amplitudes * self.fit.scale, self._own)
        columns = [self.held.shared, *self.held.columns.of(self.fit.chosen)]
        return self.held.target - np.tensordot(amplitudes, np.concatenate(columns), axes=1)

    def bare(self, trials: Sequence[int]) -> FloatArray:
        """Mean square that a subset leaves of each held-out channel, of its level (c,)."""
        return np.asarray(np.square(self.held.rms(self.residual(trials)) / self.regression.level))

    def scale(self, trials: Sequence[int]) -> FloatArray:
        """Scale of the innovations that a subset leaves (c,): robust, or their rms."""
        left = np.where(self.whole, self.innovations(trials), np.nan)
        if self.errors[1]:
            return np.asarray(np.sqrt(np.nanmean(np.square(left), axis=0)) + 1e-30)
        return np.asarray(np.nanmedian(np.abs(left), axis=0) / 0.6745 + 1e-30)

    def acts(self, trial: int) -> BoolArray:
        """Channels on which a trial acts (c,)."""
        half = self.held
        parts = [half.rms(column) / self.regression.level for column in half.columns[trial]]
        size = np.sqrt(np.mean(np.square(parts), axis=0))
        return np.asarray(size > ACTS * np.max(size))

    def impossible(self, trial: int) -> bool:
        """Whether a trial is fitted with a sign that no machine has, or far out of its range."""
        return self.regression.impossible(trial, self.fit.shares[self.places[trial]])

    def compared(self, trial: int, without: FloatArray, beside: FloatArray) -> Difference:
        """Paired test of losses (rows, c) on the channels where a trial acts."""
        counted = self.whole & self.acts(trial)
        rows = counted.any(axis=1)
        difference = np.where(counted, without - beside, 0.0).sum(axis=1)
        return paired(difference[rows], self.pieces[rows])


@dataclass(frozen=True)
class Proof:
    """What held-out rows prove.

    Attributes:
        proved: trials, in the order in which they were chosen.
        differences: paired test of each of them, beside those that were in when it passed best.
        dropped: trials that were put to proof and not proved, with p when they went.
        tested: trials that were put to proof in all.
        limit: largest p that the rate allows them.
        bench: with everything that was put to proof.
    """

    proved: tuple[int, ...]
    differences: dict[int, Difference]
    dropped: dict[int, float]
    tested: int
    limit: float
    bench: Bench


def prove(
    regression: Regression,
    held: Half,
    chosen: Sequence[int],
    more: int = 0,
    errors: tuple[bool, bool] | None = None,
) -> Proof:
    """Drop the least proved trial until the false-discovery rate is kept by all that stay.

    Each is judged by its own paired improvement of held-out rows, all others refitted without it.
    What passes beside more causes than stay is not lost when those go, unless held-out rows then
    speak against it: else one that just fails takes the next with it, as the rest describes less
    (eight more that were put to proof left 4 of TX40's 19). The rate counts those that may be
    false, not those that are plainly there. A single p may be above the rate where many are plainly
    there: a limit of 5 % on each leaves 13.7 % of TX40's torque in place of 9.1 %.

    Source: Benjamini and Hochberg 1995, with Storey's (2002) count of those without an effect, over
    all that were put to proof; dropping one by one is outside their theorem, so that the rate is
    checked by drawing (tests, the workshop suite).

    Args:
        regression: of the fitted half.
        held: the held-out half.
        chosen: trials that are put to proof.
        more: trials that were put to proof before, which count for the rate.
        errors: that are compared; those of ERRORS that show these trials best if None.
    """
    tested = len(chosen) + more
    broken = held.columns.failed(chosen)
    kept, dropped = [n for n in chosen if n not in broken], dict.fromkeys(broken, 1.0)
    back: list[int] | None = None
    whole = replace(_sharpest(regression, kept, (errors,) if errors else ERRORS), held=held)
    if not whole.whole.any():
        limit = FALSE_SHARE / max(tested, 1)
        return Proof((), {}, dict.fromkeys(chosen, 1.0), tested, limit, whole)
    bench, found = whole, _each(whole, kept)
    null = more + _null([found[n].p for n in kept])
    while True:
        passed = _passed(found, null)
        failing = [n for n in kept if n not in passed]
        worst = max(failing, key=lambda n: (found[n].p, -found[n].total), default=None)
        if worst is not None:
            kept.remove(worst)
            dropped[worst] = found[worst].p
        else:
            back = [n for n in dropped if n not in broken] if back is None else back
            again = _again(bench, kept, back, null)
            if again is None:
                limit = FALSE_SHARE * max(len(kept), 1) / null
                return Proof(tuple(kept), found, dropped, tested, limit, whole)
            back.remove(again)
            kept.append(again)
            del dropped[again]
        bench = replace(whole, fit=regression.solve(kept, whole.fit.whitening))
        before, found = found, _each(bench, kept)
        for n in passed.intersection(kept):
            if found[n].p <= NULL_FROM:
                found[n] = min(before[n], found[n], key=lambda one: one.p)


def _sharpest(
    regression: Regression, chosen: Sequence[int], kinds: Sequence[tuple[bool, bool]]
) -> Bench:
    """The bench on the fitted half by those errors that show the causes of a choice best.

    None serves all: a slow cause hardly shows in one-step errors, and plain errors have few
    independent rows. What the fitted half says of it costs held-out rows nothing: the logarithms of
    p there, each as far as one test of many asks.
    """
    enough = FALSE_SHARE / max(len(chosen), 1)
    fits = {memory: regression.fit(chosen, memory=memory) for memory in {kind[0] for kind in kinds}}
    benches = [Bench(fits[kind[0]], regression.half, regression, kind) for kind in kinds]

    def shown(bench: Bench) -> float:
        return -sum(float(np.log(max(test.p, enough))) for test in _each(bench, chosen).values())

    return max(benches, key=shown)


def _passed(found: dict[int, Difference], null: float) -> frozenset[int]:
    """As many as have p of no more than the rate times their number, of those that may be false."""
    ranked = sorted(found, key=lambda n: found[n].p)
    enough = [k for k, n in enumerate(ranked, 1) if found[n].p <= FALSE_SHARE * k / null]
    return frozenset(ranked[: max(enough, default=0)])


def _null(p: Sequence[float]) -> float:
    """How many of these trials may be without an effect: at least one, all at most."""
    high = sum(value > NULL_FROM for value in p)
    return float(np.clip((high + 1.0) / (1.0 - NULL_FROM), 1.0, max(len(p), 1)))


def _again(bench: Bench, kept: Sequence[int], back: Sequence[int], null: float) -> int | None:
    """Of those that were dropped the one that held-out rows ask for most now, if they do."""
    if not back:
        return None
    wider = replace(bench, fit=bench.regression.solve([*kept, *back], bench.fit.whitening))
    p = {n: _each(wider, [*kept, n])[n].p for n in back}
    best = min(back, key=lambda n: p[n])
    return best if p[best] <= AGAIN * FALSE_SHARE * (len(kept) + 1) / null else None


def _each(bench: Bench, kept: Sequence[int]) -> dict[int, Difference]:
    """Paired tests of all, each beside the others, by the less sure of two.

    The others refitted without it: it must be needed. The others as they are: held-out rows must
    show it, or a cause that has gone there would be proved by how badly the others mimic it. And
    the bare error must not grow: innovations weigh slow error lightly (a spring, the damper).
    """
    scale = bench.scale(kept)
    beside = loss(bench.innovations(kept), scale)
    bare = bench.bare(kept)
    found = {}
    for n in kept:
        rest, acts = [k for k in kept if k != n], bench.acts(n)
        refitted, plain = (bench.innovations(rest, of) for of in (None, kept))
        tests = [bench.compared(n, loss(e, scale), beside) for e in (refitted, plain)]
        told = replace(tests[0], p=max(test.p for test in tests))
        grows = np.sum(bench.bare(rest)[acts]) <= np.sum(bare[acts])
        found[n] = replace(told, p=1.0) if grows or bench.impossible(n) else told
    return found
