"""Channels are weighed by themselves, or together where that predicts held-out rows better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear import Linear, recorded, seen
from scipy.signal import lfilter

from ves_twin.diagnosis.build_up import weighed as weighed_module
from ves_twin.diagnosis.build_up.halves import Halves, halves_at
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.weighed import CLEARLY, weighed

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


@pytest.mark.parametrize(
    ("gain", "together"), [(1.1 * CLEARLY, True), (0.9 * CLEARLY, False), (-CLEARLY, False)]
)
def test_channels_are_weighed_together_where_that_is_clearly_better(monkeypatch, gain, together):
    """A tie of 2 nats halved a firm delay of a cylinder's speed."""
    both = halves(3, 0.9)
    told = list[np.ndarray]()

    def scores(held: object, quietest: object, left: list[np.ndarray]) -> np.ndarray:
        told.extend(left)
        return np.array([0.0, -gain])

    monkeypatch.setattr(weighed_module, "left_of", scores)
    labels = [trial.cause.label for trial in both.regression.trials]
    chosen = [labels.index("coulomb@a"), labels.index("viscous@a")]
    assert weighed(both.regression, both.held, chosen).judges.apart is not together
    apart, other = told
    assert not np.array_equal(apart, other)  # sizes of either weight


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
