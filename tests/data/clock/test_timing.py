"""Clocks and rates: order, repeats, anti-alias, holds, gaps, and the offset of two recorders."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.signals import Role
from ves_twin.data.clock.clock_offset import clock_offset
from ves_twin.data.clock.resample import resample
from ves_twin.data.clock.timeline import Timeline
from ves_twin.data.mapping.import_map import Backward, ClockMap, Gaps, Repeats, Way

MEASURED = Role.MEASUREMENT


def line(raw, **told):
    return Timeline.of(np.array(raw, float), 1e-3, ClockMap(column="t", **told), "t")


def test_repeats_keep_the_first_or_the_last_row_and_are_counted():
    raw = [0, 10, 10, 20, np.nan, 30]
    first, last = line(raw), line(raw, repeats=Repeats.LAST)
    assert list(first.rows) == [0, 1, 3, 5]
    assert list(last.rows) == [0, 2, 3, 5]
    assert (first.repeats, first.missing) == (1, 1)
    assert first.time[-1] == pytest.approx(0.03)
    with pytest.raises(InvalidInputError, match="1 rows with the time of the row before"):
        line(raw, repeats=Repeats.REFUSE)


def test_steps_back_are_refused_unless_the_map_says_what_to_do():
    raw = [0, 10, 20, 15, 18, 30, 40]
    with pytest.raises(InvalidInputError, match=r"1 steps back, first after row 3 at 0\.02 s"):
        line(raw)
    assert list(line(raw, backward=Backward.DROP).rows) == [0, 1, 2, 5, 6]
    assert list(line(raw, backward=Backward.SORT).rows) == [0, 1, 3, 4, 2, 5, 6]


def test_fewer_than_two_times_are_refused():
    with pytest.raises(InvalidInputError, match="at least 2"):
        line([5.0])


def test_stamps_in_whole_milliseconds_tell_the_true_rate_and_can_be_drawn_straight():
    true = np.arange(3000) * 0.0126173  # the admittance cycle
    kept = np.delete(true, slice(1000, 1020))
    raw = np.floor(1e3 * kept)
    plain, straight = line(raw), line(raw, even=True)
    assert plain.period == pytest.approx(0.0126173, rel=1e-4)
    assert plain.jitter == straight.jitter > 0.02
    assert straight.gaps == 1
    # whole milliseconds are half of one late, all alike
    assert np.ptp(straight.time - kept) < 2e-5
    assert np.ptp(plain.time - kept) > 9e-4


def onto(values, time, rows, way=Way.AUTO, role=MEASURED, gaps=Gaps.NAN):
    period, step = float(np.median(np.diff(time))), float(np.median(np.diff(rows)))
    return resample(values, time, period, rows, step, way, role, gaps)


FAST, SLOW = np.arange(20_000) * 1e-3, np.arange(2000) * 1e-2
INNER = slice(50, -50)


@pytest.mark.parametrize("frequency", [1.0, 20.0, 39.0])
def test_what_the_rows_can_hold_passes_the_low_pass_unchanged(frequency):
    found = onto(np.sin(2 * np.pi * frequency * FAST), FAST, SLOW)
    wanted = np.sin(2 * np.pi * frequency * SLOW)
    # 60 dB of ripple is 1e-3; the spline adds (w h)^4 / 384, 1e-5 at 39 Hz
    assert np.abs(found.values - wanted)[INNER].max() < 1.1e-3
    assert "flat to 40 Hz" in found.how


@pytest.mark.parametrize("frequency", [51.0, 80.0, 99.0, 130.0, 470.0])
def test_what_they_cannot_hold_is_taken_out_and_not_folded_back(frequency):
    found = onto(np.sin(2 * np.pi * frequency * FAST), FAST, SLOW)
    assert np.abs(found.values[INNER]).max() < 1.1e-3
    naive = np.sin(2 * np.pi * frequency * SLOW)
    assert np.abs(naive).max() > 0.5  # every tenth row would have shown it


def test_a_command_is_held_as_the_rig_holds_it():
    found = onto(np.floor(FAST), FAST, SLOW, role=Role.COMMAND)
    assert set(found.values) == set(np.floor(FAST))
    assert found.held == 0.0


def test_a_slower_channel_is_held_and_marked():
    time = np.arange(40) * 0.5
    found = onto(np.arange(40.0), time, SLOW[:1900])
    assert found.held == 0.5
    assert np.array_equal(found.values, np.floor(SLOW[:1900] / 0.5 + 1e-9))


def test_rows_of_its_own_clock_come_to_the_last_bit():
    values = np.random.default_rng(0).normal(size=len(SLOW))
    assert np.array_equal(onto(values, SLOW, SLOW.copy()).values, values)


def test_a_gap_is_empty_or_held_and_what_lies_outside_is_empty():
    keep = (FAST < 5.0) | (FAST > 7.0)
    keep &= (FAST > 1.0) & (FAST < 18.0)
    time, values = FAST[keep], np.sin(FAST[keep])
    empty = onto(values, time, SLOW).values
    bad = ~np.isfinite(empty)
    inside = (SLOW > 5.0) & (SLOW < 7.0)
    assert bad[inside].all()
    assert bad[(SLOW < 1.0) | (SLOW > 18.01)].all()
    assert not bad[(SLOW > 1.01) & (SLOW < 4.99)].any()
    assert not bad[(SLOW > 7.01) & (SLOW < 17.98)].any()
    held = onto(values, time, SLOW, gaps=Gaps.HOLD).values
    assert np.allclose(held[inside], values[time < 5.0][-1])
    assert not np.isfinite(held[SLOW < 1.0]).any()


def motion(time):
    return sum(np.sin(2 * np.pi * f * time + p) for f, p in ((0.31, 0.0), (0.73, 1.0), (1.9, 2.0)))


def two_recorders(rng, offset, noise=0.05, drift=0.0):
    main_time = np.arange(0.0, 30.0, 0.004)
    own_time = np.arange(3.0, 27.0, 0.01)
    main = motion(main_time) + noise * rng.normal(size=len(main_time))
    seen = own_time * (1.0 + drift) + offset
    own = 5.0 - 2.0 * motion(seen) + 2.0 * noise * rng.normal(size=len(own_time))
    return own_time, own, main_time, main


def test_the_offset_is_found_with_an_sd_that_means_what_it_says():
    errors = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        offset = rng.uniform(-2.0, 2.0)
        found = clock_offset(*two_recorders(rng, offset), search=10.0)
        errors.append((found.value - offset) / found.sd)
        assert found.unique
        assert found.correlation < -0.99  # one column has the other sign
        assert found.sd < 1e-3
    # 40 draws of a unit normal: rms within 0.75 and 1.25 but for 2 %, none beyond 4
    assert 0.7 < np.sqrt(np.mean(np.square(errors))) < 1.3
    assert np.abs(errors).max() < 4.0


def test_coloured_noise_widens_the_sd():
    errors = []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        own_time, own, main_time, main = two_recorders(rng, 0.7, noise=0.0)
        wander = np.convolve(rng.normal(size=len(own) + 99), np.ones(100) / 10.0, "valid")
        found = clock_offset(own_time, own + 0.5 * wander, main_time, main, 10.0)
        errors.append((found.value - 0.7) / found.sd)
    assert 0.6 < np.sqrt(np.mean(np.square(errors))) < 1.5


def test_clocks_that_run_apart_are_told():
    found = clock_offset(*two_recorders(np.random.default_rng(1), 0.5, drift=5e-4), search=10.0)
    assert found.drifts
    assert found.drift == pytest.approx(5e-4, abs=4.0 * found.drift_sd)
    steady = clock_offset(*two_recorders(np.random.default_rng(2), 0.5), search=10.0)
    assert not steady.drifts


def test_a_periodic_motion_does_not_pretend_to_be_unique():
    time = np.arange(0.0, 40.0, 0.01)
    found = clock_offset(
        time[500:3500], np.sin(2 * np.pi * time[500:3500]), time, np.sin(2 * np.pi * time), 10.0
    )
    assert not found.unique


def test_columns_that_saw_different_things_are_refused():
    rng = np.random.default_rng(3)
    time = np.arange(2000) * 0.01
    with pytest.raises(InvalidInputError, match="a correlation of"):
        clock_offset(time, rng.normal(size=2000), time, rng.normal(size=2000), 5.0)
    with pytest.raises(InvalidInputError, match="no motion"):
        clock_offset(time, np.ones(2000), time, np.ones(2000), 5.0)
