"""in_its_place: other causes that do as well in a proved one's place, by the full simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.bank.screen import AMPLITUDE, Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.paired import Difference, loss
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.stand_ins import HALF, SIGNIFICANT
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress, silent

ALIKE = 0.9
"""Cosine, beside all tolerances, of what a proved cause changes with another one's signature from
which that one is fitted in its place. Assumed: of two that are less alike columns tell."""

MOST = 2
"""Others that are fitted in the place of one: each costs a full fit of all."""

ADDS = 0.05
"""Share of what a cause changes by which it may change another thing beside what is proved than
alone, for effects to add up: where motion is fed in they do, to rounding. Assumed."""

REST = "causes fitted in the place of those that are proved"
"""What is left out where the runs are spent."""


@dataclass(frozen=True)
class Replaced:
    """Full fits with others in the place of proved causes.

    A bent cause may leave columns in which no other one can do its work, and a fit of another one
    that begins elsewhere may end far from it: dry friction of an actuator that stalls, beside its
    dead band, ended 600 000 of chi^2 behind, and does as well from the size that is alike.

    Attributes:
        proof: what is proved.
        fit: of all of it, by the full simulation.
        bank: signatures of the library at nominal, on the rows of the fitted half.
        evidence: of the fitted half.
        held: the held-out half.
        progress: told how far it is.
    """

    proof: Proof
    fit: Fit
    bank: SignatureLibrary
    evidence: Evidence
    held: Dataset
    progress: Progress = silent

    def others(self, asked: Sequence[int]) -> dict[int, list[int]]:
        """Of each asked trial those whose full fit held-out rows cannot tell from it.

        Args:
            asked: trials of the proof.
        """
        found: dict[int, list[int]] = {n: [] for n in asked}
        known = {h.label for h in self.fit.causes}
        screen = Screen(self.bank, self.evidence.whitening)
        for count, n in enumerate(asked):
            self.progress(count / len(asked), "fitting others in the place of what is proved")
            pairs = [(self._trial(label), size) for label, size in self._alike(screen, n, known)]
            tried = {
                trial: self._fitted(n, trial, sizes)
                for trial, sizes in pairs
                if trial is not None and not self.evidence.runs.budget.skips(REST)
            }
            found[n] = self._as_good(n, tried)
        return found

    def _alike(
        self, screen: Screen, trial: int, known: set[str]
    ) -> Iterator[tuple[str, FloatArray]]:
        """Causes whose signature is like what a proved one changes, and at which size."""
        runs = self.evidence.runs
        without = self.fit.shift.copy()
        without[runs.indices(self.proof.bench.regression.trials[trial].cause)] = 0.0
        change = self.evidence.whitening.apply(self.fit.prediction - runs.one(without))
        if not np.all(np.isfinite(change)):
            return
        size = max(float(change @ screen.metric.project(change)), 0.0) ** 0.5
        match = screen.match(change)
        cosine = match / np.sqrt(screen.power) / max(size, 1e-300)
        best = dict[str, int]()
        for k in np.argsort(-cosine).tolist():
            label = self.bank.hypotheses[int(self.bank.owner[k])].label
            if cosine[k] < ALIKE or len(best) == MOST:
                break
            if label not in known:
                best.setdefault(label, k)
        for label, k in best.items():
            if not self._adds(k):
                scale = float(np.clip(match[k] / screen.power[k], *AMPLITUDE))
                yield label, scale * self.bank.sizes[k]

    def _adds(self, entry: int) -> bool:
        """Whether a cause changes the same beside all that is proved as alone: columns tell it."""
        runs, cause = self.evidence.runs, self.bank.hypotheses[int(self.bank.owner[entry])]
        where = runs.indices(cause)
        there = self.fit.shift[where] + self.bank.sizes[entry]
        beside = runs.one(runs.depart(self.fit.shift, where, there)) - self.fit.prediction
        alone, rows = (
            self.evidence.whitening.apply(np.asarray(change, np.float32))
            for change in (self.bank.signature(entry), beside)
        )
        return float(np.linalg.norm(rows - alone)) < ADDS * float(np.linalg.norm(alone))

    def _trial(self, label: str) -> int | None:
        trials = self.proof.bench.regression.trials
        return next((k for k, trial in enumerate(trials) if trial.cause.label == label), None)

    def _fitted(self, trial: int, other: int | None = None, sizes: FloatArray | None = None) -> Fit:
        """All of it fitted without a trial, another one in its place from a size of that one."""
        runs, trials = self.evidence.runs, self.proof.bench.regression.trials
        causes = [trials[k].cause for k in self.proof.proved if k != trial]
        shift = self.fit.shift.copy()
        shift[runs.indices(trials[trial].cause)] = 0.0
        if other is not None and sizes is not None:
            causes.append(trials[other].cause)
            shift = runs.depart(shift, runs.indices(causes[-1]), sizes)
        return converged(self.evidence, tuple(causes), shift, shift)

    def _as_good(self, trial: int, tried: Mapping[int, Fit]) -> list[int]:
        """Those that lose less than HALF of what it took on held-out rows, and not clearly.

        Or clearly, if they fit the other half as well: what is wrong with held-out rows may be
        something else then. A leg's dry friction left 17.6 mm there, its dead band 13.2 mm, where
        both leave 3.8 mm of what they were fitted to.
        """
        bench, own = self.proof.judges.of_trial(trial), self._left(self.fit)
        scale = _rms(own, bench.whole & bench.acts(trial))

        def worse(other: Fit) -> Difference:
            return bench.compared(trial, loss(self._left(other), scale), loss(own, scale))

        told = {other: worse(fit) for other, fit in tried.items()}
        like = {
            other: one.total
            for other, one in told.items()
            if np.isfinite(one.total)
            if one.p > SIGNIFICANT or tried[other].chi2 <= self.fit.chi2
        }
        if not any(total > 0.0 for total in like.values()):
            return list(like)
        most = HALF * worse(self._fitted(trial)).total
        return [other for other, total in like.items() if total < max(most, 0.0) or total <= 0.0]

    def _left(self, fit: Fit) -> FloatArray:
        """What a fit leaves of the held-out rows that count (rows, c)."""
        fitted, runs = self.evidence.runs, self.held.runs
        point = carried_point(fitted, runs, fit.shift)
        left = np.asarray(self.held.measured - runs.one(point), float)
        lost = self.proof.bench.own_colour.lost
        return np.concatenate([left[rows][lost(k) :] for k, rows in enumerate(runs.slices)])


def _rms(rows: FloatArray, counted: BoolArray) -> FloatArray:
    squares = np.where(counted, np.square(rows), 0.0).sum(axis=0)
    return np.asarray(np.sqrt(squares / np.maximum(counted.sum(axis=0), 1)) + 1e-30)
