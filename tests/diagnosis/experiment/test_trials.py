"""Trials: the columns of a full linearisation, by fewer runs from the second programme on."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import NUISANCES, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.experiment.trials import Trials
from ves_twin.diagnosis.record.runs import Runs

ADDED = tuple(replace(p, additive=p.name == "plant.offset") for p in NUISANCES)


@dataclass(frozen=True)
class Counted(Toy):
    nuisances: tuple = ADDED
    made: tuple = ([],)

    def simulate(self, programme, values, refined=False):
        self.made[0].append(programme.name)
        return super().simulate(programme, values, refined)


def runs_of(toy, seed):
    return Runs(toy, (programme(seed),), (0, 1))


@pytest.mark.parametrize("names", [None, ("plant.gain", "plant.offset")])
def test_columns_are_those_of_a_linearisation_whatever_was_tried_before(names):
    toy, trials = Counted(made=([],)), Trials(names)
    for seed in (1, 2):
        base, (where, sd) = trials.at(runs_of(toy, seed))
        whole = linearise(runs_of(toy, seed), base.point, axes=(where, sd))
        assert base.columns == pytest.approx(whole.columns, abs=1e-5)
        assert base.prediction == pytest.approx(whole.prediction)
    assert len(where) == len(names or ADDED)


def test_what_only_adds_is_simulated_for_the_first_programme_alone():
    toy, trials = Counted(made=([],)), Trials(("plant.gain", "plant.offset"))
    trials.at(runs_of(toy, 1))
    first = len(toy.made[0])
    trials.at(runs_of(toy, 2))
    assert len(toy.made[0]) - first == 3  # nominal, its gain, the finer step


def test_a_programme_of_other_rows_has_columns_of_its_own():
    trials, fed = Trials(None), programme()
    trials.at(runs_of(Toy(nuisances=ADDED), 1))
    short = replace(fed, time=fed.time[:300], drive={"drive.u": fed.drive["drive.u"][:300]})
    base, _ = trials.at(Runs(Toy(nuisances=ADDED), (short,), (0, 1)))
    assert base.columns.shape[1] == len(base.prediction) < len(fed.time)
    offset = base.columns[2]
    assert np.ptp(offset) > 0.0
    expected = np.tile(ADDED[2].sd * np.array([1.0, 0.3]), (len(offset), 1))
    assert offset == pytest.approx(expected, rel=1e-4)  # single precision
