"""What is left: when it begins and what it goes along with."""

import numpy as np
import pytest
from toy import Toy, programme, record

from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.record.change_point import change_point
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind

RNG = np.random.default_rng


@pytest.mark.parametrize("at", [40, 301, 460])
def test_a_rise_is_dated_to_a_few_rows(at):
    z = RNG(at).standard_normal(500)
    z[at:] *= 4.0
    assert abs(change_point(z) - at) <= 4


def test_noise_has_no_rise_nor_has_what_is_loud_throughout_or_falls():
    for seed in range(200):
        assert change_point(3.0 * RNG(seed).standard_normal(400)) is None
    falling = RNG(1).standard_normal(500)
    falling[:100] *= 5.0
    assert change_point(falling) is None
    assert change_point(np.zeros(100)) is None
    assert change_point(np.ones(5)) is None


def test_empty_rows_count_for_nothing():
    z = RNG(2).standard_normal(500)
    z[300:] *= 4.0
    z[100:250] = np.nan
    assert abs(change_point(z) - 300) <= 4


def test_what_begins_in_the_middle_is_dated_and_not_by_eighths(tmp_path):
    """A slip at 5.0 s of ten was once told as from 3.8 s."""
    time = programme().time
    begin = time[0] + 0.6 * (time[-1] - time[0])
    shaken = 0.2 * RNG(9).standard_normal((len(time), 2)) * (time > begin)[:, None]
    settings = Settings(nulls=60, cache=tmp_path)
    verdict = diagnose(Toy(), [record(RNG(3), added=shaken)], settings=settings)
    assert verdict.verdict is Kind.UNKNOWN
    assert abs(verdict.leftover.onset - begin) < 0.02 * (time[-1] - time[0])


def test_drag_by_the_rate_is_told_by_its_shape_and_one_source_once(tmp_path):
    plant, fed = Toy(), programme()
    rate = np.gradient(plant.simulate(fed, {})[:, 1])
    added = np.outer(0.2 * rate * np.abs(rate) / np.max(rate**2), [1.0, 0.0])
    settings = Settings(nulls=60, cache=tmp_path)
    verdict = diagnose(plant, [record(RNG(3), added=added)], settings=settings)
    assert verdict.verdict is Kind.UNKNOWN
    features = verdict.leftover.features
    there = next(feature for feature in features if feature.channel == "out.0")
    assert there.shape == "rate |rate| of out.0"
    assert there.correlation > 0.7
    # the rates of two proportional channels, then their values: never one source twice
    assert len({(f.channel, "rate" in f.shape, f.shape[-2:]) for f in features}) == len(features)
