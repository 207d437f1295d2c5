"""Channels are weighed together or by themselves, whichever predicts held-out rows better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear import Linear, recorded, seen
from scipy.signal import lfilter

from ves_twin.diagnosis.build_up import weighed as weighed_module
from ves_twin.diagnosis.build_up.halves import Halves, halves_at
from ves_twin.diagnosis.build_up.judges import Judges
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.weighed import weighed

SMALL = 0.15
"""Dry friction, a third of the slow error beside it."""


def halves(seed: int, both: float) -> Halves:
    """Friction at the first joint, a slow error in its torque, and a share of it in the other."""
    plant = Linear(("coulomb", "viscous"))
    sides = []
    for n in (seed, seed + 1):
        record = recorded(plant, {"coulomb@a:size": SMALL}, n, error=0.02)
        rng = np.random.default_rng(50 + n)
        slow = lfilter([0.1], [1.0, -0.98], rng.standard_normal(len(record.time)))
        torque = record["torque"] + slow[:, None] * np.array([1.0, both])
        sides.append(replace(record, signals={**record.signals, "torque": torque}))
    one, two = (seen(plant, record) for record in sides)
    return halves_at(one, two, one.runs.origin, plant.hypotheses)


def ways(both: Halves, chosen: list[int]) -> dict[bool, float]:
    """Weight apart or together -> product of the rms that its plain sizes leave held out."""
    found = {}
    for apart in (True, False):
        judges = Judges.of(both.regression, chosen, apart=apart)
        proof = prove(both.regression, both.held, chosen, judges=judges)
        fit = both.regression.fit(proof.proved, memory=False, apart=apart)
        bench = replace(proof.bench, fit=fit, memory=False)
        found[apart] = float(np.prod(both.held.rms(bench.residual(proof.proved))))
    return found


@pytest.mark.parametrize("seed", [3, 5, 7, 9])
@pytest.mark.parametrize("share", [0.0, 0.9])
def test_the_weight_that_predicts_held_out_rows_better_is_kept(seed, share):
    both = halves(seed, share)
    labels = [trial.cause.label for trial in both.regression.trials]
    chosen = [labels.index("coulomb@a"), labels.index("viscous@a")]
    left = ways(both, chosen)
    assert left[True] != left[False]
    assert weighed(both.regression, both.held, chosen).judges.apart is min(left, key=left.get)


def test_where_nothing_goes_along_there_is_one_weight(monkeypatch):
    """Of a single channel."""
    both = halves(3, 0.9)
    alone = replace(both.held.runs, columns=both.held.runs.columns[:1])
    held = replace(both.held, runs=alone)
    tried = []
    monkeypatch.setattr(
        weighed_module,
        "prove",
        lambda *a: tried.append(a[-1].apart) or prove(both.regression, both.held, *a[2:]),
    )
    weighed(both.regression, held, [0])
    assert tried == [True]
