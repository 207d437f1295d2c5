"""Which next programme parts rivals: held against the closed form of a linear plant."""

import numpy as np
import pytest
from toy import Toy, programme, record

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.experiment.next_experiment import separations
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared


def test_a_programme_that_one_rival_leaves_as_it_is_parts_it_from_the_other():
    """At rest a lag shows nothing and a bump does: the bump's size is held by what was recorded."""
    plant = Toy(causes=("lag", "bump"))
    seen = preprocess(plant, [record(np.random.default_rng(4), {"lag.size": 0.05}, plant=plant)])
    runs = seen.runs
    base = linearise(runs, runs.origin)
    evidence = Evidence(runs, seen.measured, whitening_declared(runs))
    fits = [
        refine(evidence, (h,), runs.depart(runs.origin, runs.indices(h), [0.02]), base)
        for h in plant.hypotheses
        if h.effect in plant.causes
    ]
    rest = programme(8, amplitude=0.0)
    (found,) = separations(runs, fits, [rest])
    there = Runs(plant, (rest,), runs.columns)
    local = linearise(there, there.origin)
    whitening = whitening_declared(there)
    bump = next(fit for fit in fits if fit.causes[0].effect == "bump")
    shift = there.depart(there.origin, there.indices(bump.causes[0]), bump.sizes)
    trace = whitening.apply(there.one(shift) - local.prediction)
    power = float(trace @ Metric(whitening.apply(local.columns).T).project(trace))
    held = float(bump.sizes[0] ** 2 / bump.posterior[0, 0])
    # the lag leaves all of the bump's trace; the bump, of none, what its size is held by
    assert found.chi2 == pytest.approx(power * held / (power + held), rel=0.02)
    assert found.chi2 > 0.1 * min(power, held)
