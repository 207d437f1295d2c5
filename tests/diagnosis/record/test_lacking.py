"""What a model always gets wrong may grow and turn, band by band, on its own programme alone."""

import numpy as np
import pytest
from toy import PERIOD, SD, Toy, programme, record

from ves_twin.diagnosis.fit.differential import KEPT, Tuned
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.unmodelled_dynamics import BANDS, CHANGE, PARAMETERS, Lacking

PLANT = Toy()


def usual(runs):
    time = runs.times[0]
    slow, quick = np.sin(2 * np.pi * 0.5 * time), np.sin(2 * np.pi * 3.0 * time)
    return np.stack([slow + quick, slow - quick], axis=1) * SD, time


def lacking():
    runs = preprocess(PLANT, [record(np.random.default_rng(0), plant=PLANT)]).runs
    rows, time = usual(runs)
    (found,) = Lacking.of(runs, rows)
    return runs, rows, time, found


def test_the_bands_are_the_whole_and_each_turns_by_a_quarter():
    _, rows, time, found = lacking()
    growth, turn = found.traces[0::2], found.traces[1::2]
    assert len(growth) == BANDS
    within = (time > 1.0) & (time < time[-1] - 1.0)  # where the filters have no end to see
    assert growth.sum(axis=0)[within] == pytest.approx(rows[within], abs=0.1 * min(SD))
    for band, turned in zip(growth, turn, strict=True):
        cosine = np.sum(band * turned) / np.linalg.norm(band) / np.linalg.norm(turned)
        assert abs(cosine) < 0.1


def test_it_is_added_where_it_belongs_and_nowhere_else():
    runs, _, _, found = lacking()
    tuned = Tuned.to(runs, runs.origin, 1.0)
    free = Tuned(PLANT, tuned.tuned, (found,))
    one = {PARAMETERS[0].name: 1.0}
    here, elsewhere = runs.programmes[0], programme(9)
    assert free.simulate(here, one) - free.simulate(here, {}) == pytest.approx(found.traces[0])
    assert np.array_equal(free.simulate(elsewhere, one), free.simulate(elsewhere, {}))
    assert {p.name for p in free.parameters} - {p.name for p in tuned.parameters} == {
        p.name for p in PARAMETERS
    }
    assert free.identity != tuned.identity
    assert runs.grids[0].step == PERIOD


def test_what_was_tuned_far_may_change_by_more_than_what_was_not():
    runs = preprocess(PLANT, [record(np.random.default_rng(0), plant=PLANT)]).runs
    names = [axis.parameter.name for axis in runs.coordinates]
    shift = runs.origin
    shift[names.index("plant.gain")] = 0.5
    sd = {p.name: p.sd for p in Tuned.to(runs, shift, 1.0).parameters}
    assert sd["plant.gain"] == pytest.approx(CHANGE * 0.5)
    assert sd["plant.slope"] == pytest.approx(KEPT * 0.05)
    assert sd["friction.size"] == 0.0
