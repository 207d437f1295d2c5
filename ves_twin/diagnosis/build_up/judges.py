"""Judges: paired tests of causes, each by the kind of errors that shows it best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.paired import Difference, loss
from ves_twin.diagnosis.build_up.regression import Half, LinearFit, Regression

ERRORS = ((True, False), (False, False), (False, True))
"""What is compared, (memory, even): one-step prediction errors or plain ones, scaled by the middle
or evenly, by their rms. Plain errors are large where a model is wrong: by the middle that counts
for little (oil that is a spring, where a cylinder's load changes: p of 0.5 for 0.03), by the rms
a double pendulum's link is lost. Squares of one-step errors lost TX40's coupling."""

LIMIT = 0.05
"""p, divided by their number, below which a test adds nothing to how well all are shown."""

LEAST = 1e-300
"""p that stands for none: its logarithm is a number."""

CLEARER = 1.3
"""Times the logarithm of p from which other errors show a trial better than those that show all
best: p of 1e-13 and 1e-14 are alike (the damper), 5e-7 and 1e-10 are not (the six-axis arm of Liu
and Althoff). Chosen on these two."""


@dataclass(frozen=True)
class Judges:
    """Benches by several kinds of errors, and which of them judges each trial.

    None serves all: a slow cause hardly shows in one-step errors (viscous frictions of a six-axis
    arm), and plain errors have few independent rows. What the fitted half says of it costs held-out
    rows nothing.

    Attributes:
        benches: by each kind; the first shows all trials together best.
        judge: trial -> number of its bench.
        apart: whether plain errors weigh each channel of a motion by itself.
    """

    benches: tuple[Bench, ...]
    judge: Mapping[int, int]
    apart: bool = True

    @staticmethod
    def of(
        regression: Regression,
        chosen: Sequence[int],
        kinds: Sequence[tuple[bool, bool]] | None = None,
        apart: bool = True,
    ) -> Judges:
        """Those that show all together best on the fitted half, others where they are CLEARER."""
        kinds, enough = kinds or ERRORS, LIMIT / max(len(chosen), 1)
        fits = _fits(regression, chosen, {memory for memory, _ in kinds}, apart)
        benches = [
            Bench(fits[memory], regression.half, regression, memory, even) for memory, even in kinds
        ]
        shown = [_each(bench, chosen, chosen) for bench in benches]

        def together(k: int) -> float:
            return sum(float(np.log(max(test.p, enough))) for test in shown[k].values())

        def clearest(n: int) -> int:
            found = [float(np.log(max(shown[k][n].p, LEAST))) for k in order]
            best = int(np.argmin(found))
            return best if found[best] < CLEARER * found[0] else 0

        order = sorted(range(len(benches)), key=together)
        judge = {n: clearest(n) for n in chosen}
        return Judges(tuple(benches[k] for k in order), judge, apart)

    @property
    def first(self) -> Bench:
        """The bench that shows all trials together best."""
        return self.benches[0]

    def of_trial(self, trial: int) -> Bench:
        """The bench that judges a trial."""
        return self.benches[self.judge[trial]]

    def on(self, held: Half) -> Judges:
        """The same on another half."""
        return replace(self, benches=tuple(replace(one, held=held) for one in self.benches))

    def like(self, trial: int, other: int, chosen: Sequence[int]) -> Judges:
        """With another trial that is judged as one is, and the discrepancy beside other ones."""
        regression = self.first.regression
        fits = _fits(regression, chosen, {one.memory for one in self.benches}, self.apart)
        benches = tuple(replace(one, fit=fits[one.memory]) for one in self.benches)
        return replace(self, benches=benches, judge={**self.judge, other: self.judge[trial]})

    def fitted(self, kept: Sequence[int]) -> Judges:
        """With other trials fitted, the discrepancy as it is."""
        regression = self.first.regression
        known = {one.memory: one.fit.whitening for one in self.benches}
        fits = {memory: regression.solve(kept, whitening) for memory, whitening in known.items()}
        benches = tuple(replace(one, fit=fits[one.memory]) for one in self.benches)
        return replace(self, benches=benches)

    def each(
        self, kept: Sequence[int], asked: Sequence[int] | None = None
    ) -> dict[int, Difference]:
        """Paired tests beside all that are kept, each by its bench; of all of them if None."""
        found: dict[int, Difference] = {}
        for k, bench in enumerate(self.benches):
            own = [n for n in (kept if asked is None else asked) if self.judge[n] == k]
            found |= _each(bench, kept, own) if own else {}
        return found


def _fits(
    regression: Regression, chosen: Sequence[int], memories: set[bool], apart: bool
) -> dict[bool, LinearFit]:
    return {memory: regression.fit(chosen, memory=memory, apart=apart) for memory in memories}


def _each(bench: Bench, kept: Sequence[int], asked: Sequence[int]) -> dict[int, Difference]:
    """Paired tests, each beside the others, by the less sure of two.

    The others refitted without it: it must be needed. The others as they are: held-out rows must
    show it, or a cause that has gone there would be proved by how badly the others mimic it. And
    the bare error must not grow: innovations weigh slow error lightly (a spring, the damper).
    """
    scale = bench.scale(kept)
    beside = loss(bench.innovations(kept), scale)
    bare = bench.bare(kept)
    found = {}
    for n in asked:
        rest, acts = [k for k in kept if k != n], bench.acts(n)
        refitted, plain = (bench.innovations(rest, of) for of in (None, kept))
        tests = [bench.compared(n, loss(e, scale), beside) for e in (refitted, plain)]
        told = replace(tests[0], p=max(test.p for test in tests))
        grows = np.sum(bench.bare(rest)[acts]) <= np.sum(bare[acts])
        found[n] = replace(told, p=1.0) if grows or bench.impossible(n) else told
    return found
