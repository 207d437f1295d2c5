"""Builder: a record between its halves, and the best that comes of choosing causes on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.rungs import FEWER
from ves_twin.diagnosis.build_up.best_proved import best_proved, promising
from ves_twin.diagnosis.build_up.discrepancy import discrepancy, usual_shrinkage
from ves_twin.diagnosis.build_up.halves import Halves, halves_at
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.next_of_kin import next_of_kin
from ves_twin.diagnosis.build_up.offer import Offer, preferred
from ves_twin.diagnosis.build_up.plain_selector import DRY, GEARED, USUAL, PlainSelector
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.build_up.trials import Library, Trial
from ves_twin.diagnosis.build_up.weighed import weighed
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.refine import Fit, bare_residual
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress

Way = type[Selector] | type[PlainSelector]

NAMES: Mapping[Way, str] = {Selector: "one-step prediction errors", PlainSelector: "plain squares"}
"""What ways of choosing are called where one is left out."""

ROUNDS = 3
"""Times that columns are computed anew where a choice of causes, fitted in full, has moved them."""

EVEN = 1.0
"""White noise that is added to the discrepancy, as a share of its variance, where the choice of
causes is fitted in full: by innovations alone a friction with a gap slides into a wrong one (the
damper), with 10 two joints of TX40 are lost. 0.01, 1 and 10 were tried on TX40 and the damper."""

WORTH = 3.0
"""Nats of held-out rows that causes in the place of rejected ones must win for others to be looked
for in turn: odds of 20. A round takes a quarter of all; of TX40 they won 92, 4.3, 1.4 and 0."""

MOVED = 0.05
"""Share of what is left by which a full fit may differ from the linear one, TX40 moves by less
after two rounds; and by which a round may leave more than the one before (the seven-axis arm: a
third round lost all frictions)."""


ANEW = "causes chosen anew about their own fit"
"""What is left out where the runs are spent."""


@dataclass(frozen=True)
class Start:
    """A point to build up from (coordinates,), and the trials that are at work there."""

    point: FloatArray
    present: tuple[Trial, ...] = ()


@dataclass(frozen=True)
class Builder:
    """A record between its halves.

    Attributes:
        desk: the record before any cause.
        fitted, held: its halves.
        barred: labels of causes that held-out rows spoke against.
        told: what the library showed before any cause was at work; None: nothing yet.
    """

    desk: FitContext
    fitted: Dataset
    held: Dataset
    barred: frozenset[str] = frozenset()
    told: Library | None = None

    @property
    def _dear(self) -> bool:
        """Whether runs are so dear that not all sizes of causes are simulated."""
        return FEWER in self.fitted.runs.budget.left_out

    def halves(
        self, point: FloatArray, present: Sequence[Trial], progress: Progress | None = None
    ) -> Halves:
        """Both halves, linear about a point where some trials are at work."""
        library = self.told or Library(self.desk.first.screen.bank.hypotheses, fewer=self._dear)
        told = progress or self.desk.progress
        both = halves_at(self.fitted, self.held, point, library, present, told)
        self.desk.progress(0.0, "choosing causes")
        return replace(both, regression=replace(both.regression, barred=self.barred))

    def evidence(self, residual: FloatArray, memory: bool = True, apart: bool = True) -> Evidence:
        """The fitted half with the discrepancy that a residual shows.

        Sizes that are told are fitted without its memory, by plain squares: where model error is
        a law of the motion and no noise, whitening in time weighs instants that a model gets wrong
        most, and plain squares alone aim at the error that is told. Intervals count the memory.

        Args:
            residual: what the model leaves.
            memory: whether it is whitened in time.
            apart: whether channels of a motion are by themselves where it is not.
        """
        runs = self.fitted.runs
        whitening = discrepancy(runs, residual, EVEN, memory, usual_shrinkage(runs, memory, apart))
        return Evidence(self.fitted.runs, self.fitted.measured, whitening)

    def offers(
        self,
        halves: Halves,
        point: FloatArray,
        present: Sequence[Trial] = (),
        known: frozenset[str] = frozenset(),
    ) -> list[Offer]:
        """What comes of choosing by one-step prediction errors, and by plain squares.

        Neither serves all: whitening in time hides what acts slowly (a double pendulum's
        frictions, an excavator's valve), and plain squares have few independent rows (TX40). Of
        the choices that plain squares make on their way, and of all usual frictions, with rotors
        and without, and of dry friction by itself, alone and beside the last choice, the best is
        offered, too. The choice that promises more is fitted in full first: there may be no time
        for the other. One that is far behind is not, nor one that adds nothing to what was offered
        before.

        Args:
            halves: linear about the point.
            point: departures (coordinates,).
            present: trials that are at work there.
            known: labels of the causes that were put to proof before.
        """
        begin = _places(halves, present)
        plain = PlainSelector(halves.regression)
        path = plain.path(begin)
        ways: list[tuple[Way, list[int]]] = [
            (Selector, Selector(halves.regression).run(begin)),
            (PlainSelector, path[-1]),
        ]
        if known:  # what is at work there was offered already
            ways = [(way, chosen) for way, chosen in ways if set(chosen) != set(begin)]
        found = list[Offer]()
        for n in promising(halves, [chosen for _, chosen in ways], known) if ways else ():
            way, chosen = ways[n]
            if found and self.fitted.runs.budget.skips(f"causes chosen by {NAMES[way]}"):
                return found
            found.append(self.offer(*self.settled(way, halves, chosen, point), known))
            known = found[-1].known
        beside = [] if present else [[], path[-1]]
        usual = [plain.usual(kinds, some) for kinds in (DRY, USUAL, GEARED) for some in beside]
        few, known = best_proved(halves, [*path, *filter(None, usual)], known)
        labels = frozenset(halves.regression.trials[n].cause.label for n in few)
        if few and labels not in [offer.proved for offer in found]:
            found.append(self.offer(halves, point, few, known))
        return found

    def settled(
        self,
        way: Way,
        halves: Halves,
        chosen: list[int],
        point: FloatArray,
    ) -> tuple[Halves, FloatArray, list[int]]:
        """A choice about the point where all of it is fitted in full, that point, and the choice.

        Columns are of finite sizes: a choice is made anew where its full fit has moved them.
        """
        kept, least, budget = chosen, np.inf, self.fitted.runs.budget
        for last in range(ROUNDS):
            if budget.skips(ANEW):
                break
            self.desk.progress(0.0, f"fitting {_counted(chosen)}")
            regression = halves.regression
            evidence = self.evidence(regression.fit(chosen).residual)
            fit = in_full(regression, chosen, point, evidence)
            residual = np.asarray(bare_residual(evidence, fit), float)
            rms = np.maximum(regression.half.rms(residual), regression.quietest)
            left = float(np.mean(np.log(rms)))
            if not left <= least + MOVED:  # columns that hide each other, or the plant breaks off
                break
            if budget.skips(ANEW):  # columns of a whole library about that fit
                break
            linear = regression.solve(chosen, evidence.whitening).residual
            off = regression.half.rms(residual - linear)
            present = present_in([regression.trials[n] for n in chosen], fit)
            moved = self.halves(fit.shift, present)
            if not moved.sound:  # held-out recordings break off where the fitted ones do not
                break
            least, point, halves = left, fit.shift, moved
            kept = _places(halves, present)
            if np.all(off <= MOVED * regression.half.rms(linear)) or last == ROUNDS - 1:
                break
            chosen = way(halves.regression).run(kept)
        return halves, point, kept

    def offer(
        self, halves: Halves, point: FloatArray, chosen: list[int], known: frozenset[str]
    ) -> Offer:
        """What is proved of a choice, fitted in full."""
        self.desk.progress(0.0, f"putting {_counted(chosen)} to proof")
        labels = frozenset(halves.regression.trials[n].cause.label for n in chosen)
        more = len(known - labels)
        proof = next_of_kin(weighed(halves.regression, halves.held, chosen, more))
        tried = (halves.regression.trials[n].cause.label for n in (*proof.proved, *proof.dropped))
        return self._fitted(halves, point, proof, known.union(tried))

    def again(self, offer: Offer) -> list[Offer]:
        """What comes of choosing beside what is proved, without causes that were rejected.

        A cause that stood for another one leaves its place to it (TX40).
        """
        if not offer.rejected or not offer.proof.proved:
            return []
        if self.fitted.runs.budget.skips("others in the place of causes that were rejected"):
            return []
        barred = replace(self, barred=self.barred | offer.rejected)
        trials = offer.halves.regression.trials
        present = present_in([trials[n] for n in offer.proof.proved], offer.fit)
        halves = barred.halves(offer.fit.shift, present)
        if not halves.sound:
            return []
        return barred.offers(halves, offer.fit.shift, present, offer.known)

    def few(self, halves: Halves, point: FloatArray, known: frozenset[str]) -> list[Offer]:
        """What comes of the best single cause or pair: many should not end worse than these.

        Of the sets of `Selector.best` the one of which what is proved predicts best; none where
        nothing is.

        Args:
            halves: linear about the point, nothing at work there.
            point: departures (coordinates,).
            known: labels of the causes that were put to proof before.
        """
        regression = halves.regression
        if not regression.trials or self.fitted.runs.budget.skips("the best single cause or pair"):
            return []
        self.desk.progress(0.0, "choosing the best single cause or pair")
        chosen, known = best_proved(halves, Selector(regression).best(), known)
        return [self.offer(halves, point, chosen, known)] if chosen else []

    def _first_halves(self, begin: Start) -> Halves:
        """Where choosing begins; columns of a whole library take minutes, and may be ended."""
        looking = True

        def progress(share: float, what: str) -> None:
            if looking:
                self.fitted.runs.budget.stop_if_ended()
            self.desk.progress(share, what)

        halves = self.halves(begin.point, begin.present, progress)
        looking = False  # columns of held-out rows follow, of what was chosen alone
        return halves

    def best(self, start: Start | None = None) -> Offer:
        """The choice whose proved causes predict held-out rows best.

        Causes of every offer count for the rate; those that `best_proved` tried count where its
        choice was the best. Every offer is held against that count before one is preferred: the
        count may take from the best what it leaves to the next (a link of twice its mass beside a
        delay, and alone).

        Where the best of the first ones proves nothing, another that does is gone on from: what
        takes the place of its rejected causes may predict better than nothing at all (the place of
        a double pendulum's lower link).

        Args:
            start: where choosing begins; the model as it is if None.

        Raises:
            EndedError: the work was ended before anything could be chosen.
        """
        begin = start or Start(self.fitted.runs.origin)
        halves, builder = self._first_halves(begin), self
        if start is None:
            trials, causes = halves.regression.trials, self.desk.first.screen.bank.hypotheses
            builder = replace(self, told=Library.after(causes, trials, self._dear))
        offers = builder.offers(halves, begin.point, begin.present)
        found, known, every = preferred(offers), offers[-1].known, [*offers]
        named = [offer for offer in offers if offer.proof.proved]
        base = preferred(named) if named and not found.proof.proved else found
        while True:
            others = builder.again(replace(base, known=known))
            if not others:
                break
            known = others[-1].known
            every += others
            other = preferred([found, *others])
            if other is found:
                break
            builder = replace(builder, barred=builder.barred | base.rejected)
            more, base, found = other.over(found), other, other
            if more < WORTH:
                break
        few = self.few(halves, begin.point, known)
        others = [one for one in few if one.proved != found.proved]  # its own point is its fit's
        found, known = preferred([found, *others]), known.union(*(one.known for one in few))
        # one of each set of causes: others of it differ by where their columns are taken
        by_causes = {one.proved: one for one in (*every, *few)} | {found.proved: found}
        rest = [one for one in by_causes.values() if one is not found]
        return builder.about_its_fit(
            preferred([self._counted(one, known) for one in (found, *rest)])
        )

    def about_its_fit(self, offer: Offer) -> Offer:
        """An offer judged once more, linear about its own full fit, where that moved the columns.

        Offers of the same causes are linear about different points, and which of them predicts
        better may hang on rounding: their p, and with them what is firm, would hang on it, too (an
        excavator's stick, p of a delay 0.008 and 0.0006).
        """
        proof, regression = offer.proof, offer.halves.regression
        if not proof.proved or not self._moved(offer):
            return offer
        if self.fitted.runs.budget.skips("a proof about the full fit of what is proved"):
            return offer
        self.desk.progress(0.0, "proving once more what is proved, about its own fit")
        trials = regression.trials
        present = present_in([trials[n] for n in proof.proved], offer.fit)
        halves = self.halves(offer.fit.shift, present)
        if not halves.sound:
            return offer
        chosen = _places(halves, [*present, *(trials[n] for n in proof.dropped)])
        more = len(offer.known) - len(chosen)
        again = weighed(halves.regression, halves.held, chosen, more)
        told = self._fitted(halves, offer.fit.shift, again, offer.known)
        return told if told.proved == offer.proved else preferred([offer, told])

    def _moved(self, offer: Offer) -> bool:
        """Whether what a full fit leaves is not what its columns say."""
        proof, regression = offer.proof, offer.halves.regression
        evidence = self.evidence(proof.bench.fit.residual, memory=False, apart=proof.judges.apart)
        left = np.asarray(bare_residual(evidence, offer.fit), float)
        linear = regression.solve(proof.proved, evidence.whitening).residual
        off, whole = regression.half.rms(left - linear), regression.half.rms(linear)
        return bool(np.any(off > MOVED * whole))

    def _fitted(
        self, halves: Halves, point: FloatArray, proof: Proof, known: frozenset[str]
    ) -> Offer:
        """What is proved, fitted in full."""
        evidence = self.evidence(proof.bench.fit.residual, memory=False, apart=proof.judges.apart)
        fit = in_full(halves.regression, proof.proved, point, evidence)
        return Offer.of(halves, point, proof, fit, known)

    def _counted(self, offer: Offer, known: frozenset[str]) -> Offer:
        """By the count of all causes that were put to proof; what that leaves fitted anew."""
        proof, regression = offer.proof, offer.halves.regression
        chosen = [*proof.proved, *proof.dropped]
        more = len(known - {regression.trials[n].cause.label for n in chosen})
        if len(chosen) + more == proof.tested:
            return replace(offer, known=known)
        again = weighed(regression, offer.halves.held, chosen, more)
        if set(again.proved) == set(proof.proved):
            return replace(offer, proof=again, known=known)
        return self._fitted(offer.halves, offer.point, again, known)


def _counted(chosen: Sequence[int]) -> str:
    return "1 cause" if len(chosen) == 1 else f"{len(chosen) or 'no'} causes"


def _places(halves: Halves, present: Sequence[Trial]) -> list[int]:
    return [n for n, trial in enumerate(halves.regression.trials) if trial in present]


def present_in(trials: Sequence[Trial], fit: Fit) -> tuple[Trial, ...]:
    """The same causes at the sizes of a fit; those that came to nothing are gone.

    None is held to its range any more: beside causes whose columns are still to move one may pass
    its end on the way (the place of a double pendulum's lower link, whose mass centre did).
    """
    found, start = [], 0
    for trial in trials:
        count = len(trial.cause.parameters)
        sizes = tuple(fit.sizes[start : start + count].tolist())
        start += count
        if any(sizes):
            found.append(replace(trial, sizes=sizes, positive=True, bent=True))
    return tuple(found)
