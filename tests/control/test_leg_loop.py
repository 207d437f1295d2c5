"""The leg loop: the thesis's section, its place, its steady start, its limits."""

import numpy as np
import pytest
from scipy.signal import freqz, lfilter

from ves_twin.control import leg_loop
from ves_twin.control.leg_loop import FilterPlace, chebyshev_section

RATE = 1.0 / 0.001705  # Hz, five transducer periods (facts 2)
DIGITS = 1.5e-4
"""Half a unit of the fourth digit of Table 5-1, and half a hertz of rate, moving a2 by 9e-5."""
LONG_DIGITS = 5e-9
"""Half of the eighth digit of the fact sheet."""
ROUND_OFF = 1e-11
"""Spool openings: errors of 1e-15 m times gains of 20 / 0.5, summed by a filter with gain 20."""
GAIN, RATE_GAIN, FULL_SPEED, PERIOD = 20.9, 0.1, 0.5, 0.001705
RNG = np.random.default_rng(15)


@pytest.fixture(params=list(FilterPlace))
def place(request) -> FilterPlace:
    return request.param


def blocks(place, rate_gain=RATE_GAIN):
    p, s = np.zeros(1, leg_loop.PARAMETERS), np.zeros(1, leg_loop.STATE)
    p["gain"], p["rate_gain"], p["place"] = GAIN, rate_gain, place.code
    p["limit"] = 1.0
    p["numerator"], p["denominator"] = chebyshev_section(RATE)
    p["period"], p["full_speed"] = PERIOD, FULL_SPEED
    return p, s


def control(p, s, length):
    valve = np.full(6, np.nan)
    leg_loop.control_legs(p[0], s[0], np.asarray(length, float), valve)
    return valve


def test_the_section_has_the_digits_of_table_5_1():
    """Signs of errata E-43."""
    numerator, denominator = chebyshev_section(586.5)
    np.testing.assert_allclose(numerator, [0.6040, -1.1969, 0.6040], rtol=0, atol=DIGITS)
    np.testing.assert_allclose(denominator, [1.0, -1.9002, 0.9113], rtol=0, atol=DIGITS)


def test_at_587_hz_the_section_has_the_fact_sheet_s_digits():
    numerator, denominator = chebyshev_section(587.0)
    np.testing.assert_allclose(
        numerator, [0.60401833, -1.19686013, 0.60401833], rtol=0, atol=LONG_DIGITS
    )
    np.testing.assert_allclose(
        denominator, [1.0, -1.90016401, 0.91134054], rtol=0, atol=LONG_DIGITS
    )


def test_the_section_s_notch_is_at_12_72_hz():
    numerator, _ = chebyshev_section(586.5)
    zeros = np.roots(numerator)
    np.testing.assert_allclose(np.abs(zeros), 1.0, rtol=0, atol=1e-12)  # a full notch
    np.testing.assert_allclose(
        np.abs(np.angle(zeros)) * 586.5 / (2 * np.pi), 12.72, rtol=0, atol=0.01
    )


def test_the_section_attenuates_as_the_fact_sheet_s_table_says():
    hertz = [0.5, 5.0, 7.0, 9.0, 10.0, 11.0, 15.0, 20.0, 50.0]
    decibel = [0.0, -0.2, -1.1, -4.0, -6.9, -11.5, -13.0, -7.2, -4.1]
    degrees = [-2.4, -29.0, -49.0, -75.0, -89.0, -101.0, 47.0, 30.0, 10.0]
    _, response = freqz(*chebyshev_section(587.0), worN=hertz, fs=587.0)
    # the printed values are rounded to 0.1 dB and to a degree; -11.5, 15 and 50 Hz to half that
    np.testing.assert_allclose(20 * np.log10(np.abs(response)), decibel, rtol=0, atol=0.3)
    np.testing.assert_allclose(np.degrees(np.angle(response)), degrees, rtol=0, atol=1.0)


def test_the_section_passes_what_stands_still():
    numerator, denominator = chebyshev_section(RATE)
    assert abs(numerator.sum() / denominator.sum() - 1.0) < 1e-10


@pytest.mark.parametrize("rate_gain", [0.0, RATE_GAIN])
def test_the_loop_is_a_gain_and_the_section_at_its_place(place, rate_gain):
    """Against scipy's filter of the error, of the measured length, or none at all."""
    p, s = blocks(place, rate_gain)
    lengths, commands = RNG.normal(size=(2, 300, 6)) * 1e-3
    found = []
    for length, command in zip(lengths, commands, strict=True):
        s["command"] = command
        found.append(control(p, s, length))
    b, a = chebyshev_section(RATE)
    error = {
        FilterPlace.NONE: commands - lengths,
        FilterPlace.ERROR: lfilter(b, a, commands - lengths, axis=0),
        FilterPlace.FEEDBACK: commands - lfilter(b, a, lengths, axis=0),
    }[place]
    speed = np.diff(lengths, axis=0, prepend=0.0) / PERIOD
    expected = (GAIN * error - rate_gain * speed) / FULL_SPEED
    np.testing.assert_allclose(found, np.clip(expected, -1, 1), rtol=0, atol=ROUND_OFF)
    assert np.mean(np.abs(expected) < 1.0) > 0.5  # the comparison is not one of limits


def test_the_start_is_a_steady_state(place):
    p, s = blocks(place)
    length = RNG.uniform(0.9, 1.2, 6)
    leg_loop.start_legs(p[0], s[0], length)
    for _ in range(50):
        np.testing.assert_allclose(control(p, s, length), 0.0, rtol=0, atol=ROUND_OFF)


def test_after_the_start_the_loop_answers_as_if_it_had_always_stood_there(place):
    p, s = blocks(place)
    length = RNG.uniform(0.9, 1.2, 6)
    q, waited = blocks(place)
    waited["command"] = waited["previous"] = length
    for _ in range(5000):
        control(q, waited, length)
    leg_loop.start_legs(p[0], s[0], length)
    for _ in range(20):
        length = length + 1e-4
        np.testing.assert_allclose(
            control(p, s, length), control(q, waited, length), rtol=0, atol=1e-9
        )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_spool_saturates_at_full_opening(place, sign):
    p, s = blocks(place)
    leg_loop.start_legs(p[0], s[0], np.ones(6))
    s["command"] += sign * 0.3  # 0.3 m times 20.9 1/s is 12 times full speed
    for _ in range(3):
        valve = control(p, s, np.ones(6))
        np.testing.assert_array_equal(valve, sign)


def test_a_command_above_the_length_opens_the_valve_to_extend():
    p, s = blocks(FilterPlace.NONE)
    leg_loop.start_legs(p[0], s[0], np.ones(6))
    s["command"][0, 2] += 0.01
    expected = np.zeros(6)
    expected[2] = GAIN * 0.01 / FULL_SPEED
    np.testing.assert_allclose(control(p, s, np.ones(6)), expected, rtol=0, atol=ROUND_OFF)
