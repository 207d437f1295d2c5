"""A record against recordings of the same rig in order: what is compared, and what is said."""

from dataclasses import replace

import numpy as np
import pytest
from toy import Toy, record

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.report.diagnosis.answer import headline
from ves_twin.report.diagnosis.basis import basis_sentences

SETTINGS = Settings(nulls=40, simulated_nulls=False)
USUAL = 0.03
"""Ripple that the rig always has and the library, without it, lacks."""


def rig(seed, size=0.0):
    values = {"ripple.size": USUAL, "friction.size": size}
    return record(np.random.default_rng(seed), values, spread=0.0)


def test_a_departure_from_the_baseline_is_told_as_a_change_since_then():
    values = {"plant.gain": 0.06, "ripple.size": USUAL}
    changed = record(np.random.default_rng(5), values, spread=0.0)
    plant = Toy().without("ripple")
    found = diagnose(plant, [changed], baseline=[rig(2), rig(3)], settings=SETTINGS)
    size = found.causes[0].parameters["plant.gain"]
    assert found.causes[0].sigmas == pytest.approx((size.value - size.nominal) / (0.3 * 0.02))
    assert "(at the baseline " in found.words
    loose = replace(found, causes=(replace(found.causes[0], firm=False),))
    assert "sigmas of a change since then" in loose.words
    page = headline(loose) + " ".join(basis_sentences(loose))
    assert "since its baseline" in page
    for said in (found.words, loose.words, page):
        assert "declared sigmas" not in said
        assert "declared tolerances off" not in said


@pytest.mark.parametrize("rate", [40.0, 100.0])
def test_the_baseline_is_on_the_grid_of_the_record(rate):
    settings = Settings(nulls=40, simulated_nulls=False, rate=rate)
    plant = Toy().without("ripple")
    found = diagnose(plant, [rig(1, 0.1)], baseline=[rig(2), rig(3)], settings=settings)
    assert (found.verdict, found.causes[0].effect) == (Kind.NAMED, "friction")
    same = diagnose(plant, [rig(4)], baseline=[rig(2), rig(3)], settings=settings)
    assert same.verdict is Kind.NOTHING


def moved(recording, rows, wobble=0.0):
    """A recording that begins earlier by rows, with inputs that are repeated less exactly."""
    rng = np.random.default_rng(99)
    signals = {}
    for name, values in recording.signals.items():
        before = np.repeat(values[:1], rows, axis=0)
        signals[name] = np.concatenate([before, values])
        if name.startswith("drive"):
            spread = np.ptp(values) * wobble
            signals[name] = signals[name] + spread * rng.uniform(-1.0, 1.0, signals[name].shape)
    step = recording.time[1] - recording.time[0]
    time = step * np.arange(len(recording.time) + rows)
    return replace(recording, time=time, signals=signals)


def test_a_baseline_that_begins_earlier_is_moved_to_where_its_motion_repeats():
    plant = Toy().without("ripple")
    usual = [moved(rig(2), 37, 0.002), moved(rig(3), 12, 0.002)]
    found = diagnose(plant, [rig(1, 0.1)], baseline=usual, settings=SETTINGS)
    assert (found.verdict, found.causes[0].effect) == (Kind.NAMED, "friction")
    assert 1e-3 < found.basis.baseline_differs < 5e-3
    assert "differ from the record's by up to" in " ".join(basis_sentences(found))
    same = diagnose(plant, [rig(4)], baseline=usual, settings=SETTINGS)
    assert same.verdict is Kind.NOTHING


@pytest.mark.parametrize(
    ("usual", "words"),
    [
        (lambda: moved(rig(2), 3, 0.1), "inputs that differ by .* of their range"),
        (lambda: shortened(rig(2)), "rows for .*cut the record"),
    ],
)
def test_a_baseline_of_another_motion_is_refused_with_what_differs(usual, words):
    with pytest.raises(InvalidInputError, match=words):
        diagnose(Toy().without("ripple"), [rig(1)], baseline=[usual()], settings=SETTINGS)


def shortened(recording):
    signals = {name: values[:-40] for name, values in recording.signals.items()}
    return replace(recording, time=recording.time[:-40], signals=signals)
