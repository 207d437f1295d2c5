"""What a recording's own departure changes is simulated for that recording alone."""

from __future__ import annotations

import numpy as np
from toy import Toy, record

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.record.last_runs import KEPT, LastRuns
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.runs import Runs


class Counted(Toy):
    """That counts its simulations."""

    calls = 0

    def simulate(self, programme, values, refined=False):
        type(self).calls += 1
        return super().simulate(programme, values, refined)


def test_columns_are_those_of_a_run_of_all_recordings_and_cost_fewer():
    recordings = [record(np.random.default_rng(k)) for k in range(3)]
    runs = preprocess(Counted(), recordings).runs
    own = [axis.recording for axis in runs.coordinates]
    assert max(own) == 2  # the toy has a start of its own in each
    Counted.calls = 0
    point = runs.origin
    stacks = runs.many([point, *(point + 0.01 * row for row in np.eye(len(point)))])
    alone = sum(one >= 0 for one in own)
    assert Counted.calls == 3 * (1 + len(point) - alone) + alone
    for row, stack in zip(np.eye(len(point)), stacks[1:], strict=True):
        fresh = Runs(runs.forward, runs.programmes, runs.columns)
        np.testing.assert_array_equal(stack, fresh.one(point + 0.01 * row))
    assert np.all(np.isfinite(linearise(runs, point).columns))


def test_only_the_last_few_are_kept():
    kept, rows = LastRuns(), np.zeros((2, 1), np.float32)
    for n in range(KEPT + 1):
        kept.keep((0, False, bytes([n])), rows + n)
    assert kept.get((0, False, bytes([0]))) is None
    assert kept.get((0, False, bytes([KEPT]))) is not None
    assert kept.get((1, False, bytes([KEPT]))) is None


def test_columns_about_a_point_are_simulated_once():
    """Both starts of a fit, and the next choice of causes, begin where the last one did."""
    runs = preprocess(Counted(), [record(np.random.default_rng(3))]).runs
    point = runs.origin + 0.01
    first = linearise(runs, point)
    Counted.calls = 0
    np.testing.assert_array_equal(linearise(runs, point).columns, first.columns)
    assert Counted.calls == 0
    linearise(runs, 2.0 * point)
    assert Counted.calls > len(runs.nuisances)
    Counted.calls = 0
    linearise(runs, point, forward_step=0.5)  # other columns: of one side
    assert Counted.calls > len(runs.nuisances)
