"""The filter of the leg program at another place, as a cause with a size."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.control.leg_loop import FilterPlace
from ves_twin.diagnosis.model.forward import Excitation, check_forward
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.verdict.cause import Cause
from ves_twin.diagnosis.verdict.verdict import Basis, Kind, Statistics, Verdict
from ves_twin.machines.ves2.effects_of import effects_of
from ves_twin.machines.ves2.filter_place import WithFilterPlaces
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.machines.ves2.inputs import one_step
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.replay import replay_scenario
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.ves2 import BlindVes2

SHORT = {"run.duration": 1.5, "run.settle": 0.3, "arm.moves": []}


@pytest.fixture(scope="module")
def plant():
    return vt.Plant.load("ves2_pressure_fast")


def rig(plant, place):
    scenario = Scenario.load("identify_fast", {**SHORT, "legs.filter": place})
    recording = vt.simulate(scenario, plant=plant)
    forward = RigForward(plant, one_step(replay_scenario(recording)))
    return forward, Excitation.of(recording, DRIVE, place)


@pytest.fixture(scope="module")
def unfiltered(plant):
    return rig(plant, "none")


def test_a_whole_share_is_the_program_with_the_filter_there(unfiltered, plant):
    forward, programme = unfiltered
    wrapped = WithFilterPlaces(forward)
    check_forward(wrapped)
    assert np.array_equal(wrapped.simulate(programme, {}), forward.simulate(programme, {}))
    other, _ = rig(plant, "feedback")
    there = other.simulate(programme, {})
    moved = wrapped.simulate(programme, {"filter_place@feedback:share": 1.0})
    np.testing.assert_allclose(moved, there, rtol=0, atol=1e-9 * np.abs(there).max())
    nominal = forward.simulate(programme, {})
    legs = np.abs(there - nominal)[:, :6].max()
    assert legs > 20 * forward.channels[0].sd  # it shows in the lengths
    half = wrapped.simulate(programme, {"filter_place@feedback:share": 0.5})
    np.testing.assert_allclose(
        half, 0.5 * (nominal + there), rtol=0, atol=1e-9 * np.abs(there).max()
    )


def test_the_two_other_places_are_two_causes_that_are_no_copies(unfiltered):
    forward, programme = unfiltered
    wrapped = WithFilterPlaces(forward)
    assert [h.label for h in wrapped.hypotheses[-2:]] == [
        "filter_place@error",
        "filter_place@feedback",
    ]
    runs = Runs(wrapped, (programme,), tuple(range(6)))
    base = runs.one(runs.origin)
    error, feedback = (
        (runs.one(runs.depart(runs.origin, runs.indices(h), np.ones(1))) - base).ravel()
        for h in wrapped.hypotheses[-2:]
    )
    cosine = error @ feedback / np.linalg.norm(error) / np.linalg.norm(feedback)
    assert abs(cosine) < 0.999
    # on the error the command is filtered, too: the legs come later
    assert np.linalg.norm(error - feedback) > 0.1 * np.linalg.norm(feedback)


def test_an_edge_is_left_out_where_there_is_no_filter(plant):
    forward, programme = rig(plant, "error")
    wrapped = WithFilterPlaces(forward)
    assert wrapped.places == (FilterPlace.NONE, FilterPlace.FEEDBACK)
    values = {"filter_edge@legs:share": 0.1, "filter_place@none:share": 1.0}
    assert np.all(np.isfinite(wrapped.simulate(programme, values)))


def test_a_recording_says_the_scenario_as_it_is_written_not_as_it_is_deployed():
    bench = BlindVes2("ves2_pressure_fast")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ves_twin.suites.ves2.SECONDS", 1.0)
        plain, odd = (
            bench.record(BlindRig(deployed=deployed), "train", np.random.default_rng(0))
            for deployed in ({}, {"legs.filter": "feedback"})
        )
    assert plain.info.settings == odd.info.settings
    assert '"filter":"none"' in odd.info.settings
    # the same noise and the same disturbance: what differs is the program
    assert np.abs(plain["leg.length"] - odd["leg.length"]).max() > 2e-4


def test_a_place_is_no_part_of_an_extended_plant():
    cause = Cause("filter_place", "feedback", {}, 1.0, firm=True, sigmas=None)
    basis = Basis("declared", "declared", "none")
    verdict = Verdict(Kind.NAMED, basis, Statistics(1.0, 1.0, 1.0, 1.0), (cause,), ((0,),))
    assert effects_of(verdict) == ()
