"""Intervals where several parameters together leave the record as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import QUICK, SD, Toy, programme, shape

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.explain.judge import judge
from ves_twin.diagnosis.fit.assess import assess, pull_limit
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.fit.probe import probe
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.model.forward import Parameter
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared

GAIN, MASS, LEVEL = 1.003, 0.996, 0.4
PRIOR = {"plant.gain": 0.002, "plant.mass": 0.005}


LEAK = Parameter("leak.size", "1", 0.0, 0.0, 1.0, sd=1e-3)
"""What is not there cannot become less."""


class Driven(Toy):
    """(gain u - friction sign u) / mass: all three scaled together, it moves the same."""

    def simulate(self, programme, values, refined=False):
        u, time = programme.drive["drive.u"][:, 0], programme.time
        value = {p.name: p.nominal for p in self.parameters} | dict(values)
        force = 100.0 * value["plant.gain"] * u[:, None] * [0.3, 1.0]
        force = force - 100.0 * value["friction.size"] * shape("friction", u, time)
        return (force + value.get(LEAK.name, 0.0) * shape("bump", u, time)) / value["plant.mass"]


@pytest.fixture(scope="module", params=[(), (LEAK,)], ids=["free", "at a bound"])
def evidence(request):
    fed = programme()
    nuisances = tuple(Parameter(n, "1", 1.0, 0.0, 2.0, sd=sd) for n, sd in PRIOR.items())
    nuisances = (*nuisances, *request.param)
    plant = Driven(causes=("friction",), with_gain=False, nuisances=nuisances)
    runs = Runs(plant, (fed,), (0, 1))
    rows = plant.simulate(fed, {"plant.gain": GAIN, "plant.mass": MASS, "friction.size": LEVEL})
    rows = rows + np.random.default_rng(3).standard_normal(rows.shape) * SD
    return Evidence(runs, rows.astype(np.float32), whitening_declared(runs))


def begun(evidence, share, seed):
    """The cause, its true size, and columns there that are a share of themselves off."""
    runs, rng = evidence.runs, np.random.default_rng(seed)
    (cause,) = runs.forward.hypotheses
    shift = runs.depart(runs.origin, runs.indices(cause), np.array([LEVEL]))
    local = linearise(runs, shift)
    sizes = np.linalg.norm(local.columns[:-1], axis=(1, 2)) / np.sqrt(local.columns[0].size)
    off = rng.standard_normal(local.columns[:-1].shape) * share * sizes[:, None, None]
    wrong = replace(local, columns=np.concatenate([local.columns[:-1] + off, local.columns[-1:]]))
    return (cause,), shift, wrong


@pytest.fixture(scope="module")
def fits(evidence):
    """Of a record, by columns that are three per cent off: as they are, and probed."""
    return [refine(evidence, *begun(evidence, 0.03, 4), probed=probed) for probed in (False, True)]


@pytest.fixture(params=[3, 4, 5])
def stuck(evidence, request):
    """A search that set out with all forces and masses 2 % low, by columns that are 10 % off."""
    causes, shift, wrong = begun(evidence, 0.1, request.param)
    low = shift.copy()
    low[evidence.runs.nuisances] = -0.02
    low[evidence.runs.indices(causes[0])] *= 0.98
    return refine(evidence, causes, low, wrong)


def test_errors_of_the_columns_do_not_pass_for_information(fits):
    """Scaling moves nothing, so what is known of the scale is what both priors tell, divided."""
    plain, probed = (float(np.sqrt(fit.covariance[0, 0])) / LEVEL for fit in fits)
    relative = np.array(list(PRIOR.values()))
    scale = 1.0 / np.sqrt(np.sum(relative**-2))
    # two per cent: what the record itself tells of friction, and a curvature right to a tenth
    assert probed == pytest.approx(scale, rel=0.06)
    assert plain < 0.8 * scale


def test_the_other_numbers_of_the_direction_are_put_right_too(fits):
    gain = float(np.sqrt(fits[1].posterior[1, 1]))
    assert gain == pytest.approx(1.0 / np.sqrt(sum(sd**-2 for sd in PRIOR.values())), rel=0.06)


def test_the_true_size_lies_within_the_interval(fits):
    off = (fits[1].sizes[0] - LEVEL) / np.sqrt(fits[1].covariance[0, 0])
    assert abs(off) < 3.3


def test_a_probed_fit_goes_all_the_way_by_the_jacobian_that_was_put_right(evidence, stuck):
    """Not by the short steps that the columns before have come to."""
    at = (evidence, stuck.causes, stuck.shift, stuck.local, 0, stuck.step_share)
    probed = refine(*at, probed=True)
    assert probed.sizes[0] == pytest.approx(LEVEL, rel=0.005)
    assert probed.pull < 2.0


def test_a_cause_is_not_given_up_for_an_error_that_the_record_does_not_ask_for(evidence, stuck):
    bank = build_bank(evidence.runs)
    first = assess(evidence.measured, bank, evidence.whitening, 15.0, 5.0, 4.0)
    desk = FitContext(first, Thresholds(15.0, 5.0, np.zeros(0), np.zeros(0)), QUICK, silent)
    found = judge(desk, [stuck])
    assert found.best.pull < pull_limit(bank, QUICK.alpha)
    assert found.best.sizes[0] == pytest.approx(LEVEL, rel=0.005)
    assert found.adequate


def test_a_size_that_the_record_does_not_show_has_no_direction():
    """As the limit of an actuator that nothing reaches."""

    class Blind:
        free = np.array([0])

        def hessian(self, jacobian):
            return np.zeros((2, 2))

    columns = np.zeros((8, 2))
    assert probe(Blind(), None, columns) is columns
