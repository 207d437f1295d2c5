"""nearest: few causes that predict best where none is proved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.diagnosis.build_up.bench import Bench


def nearest(bench: Bench, few: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Of sets of trials the one that leaves least of held-out rows, by plain squares.

    Sizes are of the fitted half. Only what leaves no channel more than nothing at all does counts:
    what stands for a gain on one joint may ruin another (the double pendulum).

    Args:
        bench: with any trials; its discrepancy counts.
        few: sets of trials.

    Returns:
        Trials; none where each set leaves some channel more.
    """
    every = list(dict.fromkeys([*bench.fit.chosen, *(n for some in few for n in some)]))
    common = replace(bench, fit=bench.regression.solve(every, bench.fit.whitening))
    nothing = common.bare(())
    left = {tuple(some): common.bare(some) for some in few}
    sound = {some: rest for some, rest in left.items() if np.all(rest <= nothing)}
    return min(sound, key=lambda some: float(np.sum(sound[some])), default=())
