"""A linear cause keeps its range: rounding does not bend its column, nor does being at work."""

from __future__ import annotations

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from linear import Linear, halves, recorded, seen

from ves_twin.diagnosis.build_up.builder import present_in
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.trials import trials_at

FAINT = 2e-5
"""What a unit of the faint cause adds [N m], as a hand's inertia does beside its weight."""


class Loaded(Linear):
    """A weight of 40 N m at both joints, and a harmonic that is next to nothing."""

    def simulate(self, programme, values, refined=False):
        kinds = [name for name in values if name.startswith("harmonic")]
        return 40.0 + super().simulate(
            programme, values | {name: FAINT * values[name] for name in kinds}, refined
        )


def test_what_is_linear_but_for_rounding_is_linear():
    """Predictions have seven digits: of 40 N m a tenth of a column of 1e-4 N m is rounding."""
    plant = Loaded()
    runs = seen(plant, recorded(plant, {}, 3)).runs
    trials, columns = trials_at(runs, runs.origin, plant.hypotheses)
    found = {t.cause.label: (t, c) for t, c in zip(trials, columns, strict=True)}
    trial, column = found["harmonic@a"]
    assert not trial.bent
    assert np.abs(column).max() < 5.0 * FAINT
    others = {label for label, (t, _) in found.items() if t.bent}
    assert others == set()


def test_a_linear_cause_at_work_may_not_leave_its_range():
    """At the end of its range, where it took nothing away, one was proved at 64 times that."""
    both = halves(Linear(), {"coulomb@a:size": 0.8}, 51)
    trials = both.regression.trials
    (one,) = (t for t in trials if t.cause.label == "spring@b")
    assert not one.bent
    (there,) = present_in([one], SimpleNamespace(sizes=np.array([25.0])))
    assert (there.sizes, there.positive, there.bent) == ((25.0,), True, False)
    regression = Regression(
        both.regression.half, [replace(t) if t != one else there for t in trials]
    )
    n = regression.trials.index(there)
    low, high = regression.limits[n]
    assert low == 0.0
    assert high * regression.prior[n] == pytest.approx(2.0)  # 50 is the end of its range
    assert regression.impossible(n, 2.0 * high)
    assert not regression.impossible(n, high)


def test_a_size_of_two_that_came_to_nothing_has_no_limit_and_warns_of_nothing():
    both = halves(Linear(), {"coulomb@a:size": 0.8}, 51)
    (n,) = (k for k, t in enumerate(both.regression.trials) if t.cause.label == "spring@b")
    none = replace(both.regression.trials[n], sizes=(0.0,), positive=True)
    trials = [none if k == n else t for k, t in enumerate(both.regression.trials)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        low, high = Regression(both.regression.half, trials).limits[n]
    assert low == 0.0
    assert high > 1e200
