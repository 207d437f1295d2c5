"""The tolerance envelope of a comparison: where a machine in order may lie."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum import BLIND, DAMPING, MACHINE

from ves_twin.machines.compare import compare
from ves_twin.machines.load import machine_of
from ves_twin.report.comparison.page import comparison_page
from ves_twin.report.comparison.words import envelope_sentence
from ves_twin.suites.machine import BlindRig


def of(values, seed, **options):
    rng = np.random.default_rng(seed)
    rig = BlindRig(BLIND.commissioned(rng, 1.0) | values)
    measured = BLIND.record(rig, "train", rng)
    return compare([measured], machine_of(MACHINE), **options).recordings[0]


@pytest.fixture(scope="module")
def in_order():
    return [of({}, seed) for seed in range(12)]


@pytest.fixture(scope="module")
def damped():
    return of({DAMPING: 0.09}, 3)


def test_machines_in_order_lie_in_the_envelope_as_often_as_two_sd_say(in_order):
    shares = [share for one in in_order for share in one.outside.values()]
    assert np.mean(shares) == pytest.approx(0.046, abs=0.05)
    assert np.median([len(one.beyond_noise) for one in in_order]) == 2  # noise alone says nothing


def test_a_fault_leaves_the_envelope_and_the_page_says_so(damped):
    assert damped.outside["joint.angle"] > 0.5
    told = envelope_sentence(damped)
    assert told.startswith("Tolerances: 2 of 2 columns leave the band of a machine in order")


def test_a_band_that_is_wider_than_a_signal_moves_is_said_to_tell_nothing(in_order):
    """A card that swung by 67 mrad, 1.74 rad off, was "in order" without a word."""
    one = next(one for one in in_order if max(one.outside.values()) < 0.05)
    assert "wider than it moves" not in envelope_sentence(one)
    wide = {name: 100.0 * sd for name, sd in one.traces.reach.items()}
    told = envelope_sentence(replace(one, traces=replace(one.traces, reach=wide)))
    assert "joint.angle" in told
    assert "tells next to nothing" in told


def test_an_envelope_that_takes_too_long_is_a_note_that_says_how_to_get_it(in_order):
    one = of({}, 0, patience=0.0)
    assert one.outside == {}
    assert envelope_sentence(one) == ""
    assert any("ask with --envelope" in note for note in one.notes)
    assert [c.rms for c in one.channels] == [c.rms for c in in_order[0].channels]


def test_the_first_screen_of_a_comparison_has_a_picture_with_the_envelope():
    rng = np.random.default_rng(0)
    page = comparison_page(compare([BLIND.record(BlindRig(), "train", rng)], machine_of(MACHINE)))
    first = page[: page.index("<section>")]
    assert "<figure>" in first
    assert "where a machine in order may lie" in first
