"""The force sensor's chain: steady start, low-pass, cross-talk, range, counts, zero, noise."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from ves_twin.plant.physics import force_sensor

TICK = 341e-6
CORNER = 20.0
STEADY = 1e-9
"""N. The filter's poles are within 0.03 of 1, which lifts round-off of 1e3 N by some 1e3."""
GAIN = 1e-6
"""A fitted sine after the transient has died by e^-40."""
QUIET = np.zeros(6, np.float32)
RNG = np.random.default_rng(11)
WRENCH = np.array([30.0, -20.0, -900.0, 60.0, -75.0, 4.0])


@pytest.fixture
def blocks():
    """An ideal sensor with the thesis's low-pass; tests switch errors on."""
    p, s = np.zeros(1, force_sensor.PARAMETERS), np.zeros(1, force_sensor.STATE)
    p["gain"] = p["calibration"] = np.eye(6)
    p["numerator"], p["denominator"] = butter(2, CORNER, fs=1.0 / TICK)
    p["range"] = 1e9
    return p, s


def sample(blocks, wrench, time=0.0, white=QUIET):
    p, s = blocks
    inside = force_sensor.sample_wrench(p[0], s[0], np.asarray(wrench, float), time, white)
    return inside, s["reading"][0].copy()


def start(blocks, wrench, wander=QUIET):
    p, s = blocks
    force_sensor.start_at(p[0], s[0], np.asarray(wrench, float), wander)


def test_the_start_is_a_steady_state(blocks):
    p, s = blocks
    p["gain"] = np.eye(6) + 0.02 * RNG.normal(size=(6, 6))
    p["offset"] = [3.0, -2.0, 5.0, 1.0, -1.5, 0.5]
    p["wander"] = 0.3
    start(blocks, WRENCH, wander=np.ones(6, np.float32))
    first = s["signal"][0].copy()
    for _ in range(100):
        sample(blocks, WRENCH)
        np.testing.assert_allclose(s["signal"][0], first, rtol=0, atol=STEADY)
    np.testing.assert_allclose(
        first, p["gain"][0] @ WRENCH + p["offset"][0] + 0.3, rtol=0, atol=STEADY
    )


def test_the_gain_at_rest_is_one(blocks):
    start(blocks, np.zeros(6))
    for _ in range(3000):  # 1 s: 90 time constants
        _, reading = sample(blocks, WRENCH)
    np.testing.assert_allclose(reading, WRENCH, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("frequency", "gain"),
    [(CORNER, np.sqrt(0.5)), (2.0, 1.0 / np.sqrt(1 + 0.1**4)), (200.0, 1.0 / np.sqrt(1 + 10.0**4))],
)
def test_a_sine_is_passed_as_a_second_order_butterworth_filter_does(blocks, frequency, gain):
    """-3 dB at the corner exactly; elsewhere the analog law at the warped frequency."""
    start(blocks, np.zeros(6))
    time = TICK * np.arange(6000)
    out = np.array(
        [sample(blocks, np.full(6, np.sin(2 * np.pi * frequency * t)))[1][0] for t in time]
    )
    late = time > 1.0
    angle = 2 * np.pi * frequency * time[late]
    fit, *_ = np.linalg.lstsq(
        np.column_stack([np.sin(angle), np.cos(angle)]), out[late], rcond=None
    )
    warp = np.tan(np.pi * frequency * TICK) / np.tan(np.pi * CORNER * TICK)
    assert abs(np.hypot(*fit) - 1.0 / np.sqrt(1 + warp**4)) < GAIN
    assert abs(np.hypot(*fit) - gain) < 0.05 * gain  # warping shifts 200 Hz by 2 %


def test_the_chain_is_the_filter_of_scipy(blocks):
    start(blocks, np.zeros(6))
    series = RNG.normal(size=(300, 6))
    out = np.array([sample(blocks, row)[1] for row in series])
    b, a = butter(2, CORNER, fs=1.0 / TICK)
    np.testing.assert_allclose(out, lfilter(b, a, series, axis=0), rtol=0, atol=1e-12)


def test_cross_talk_carries_one_axis_into_another(blocks):
    p, _ = blocks
    p["gain"][0, 3, 2] = 0.01  # Fz into Mx
    start(blocks, WRENCH)
    _, reading = sample(blocks, WRENCH)
    expected = WRENCH + np.array([0, 0, 0, 0.01 * WRENCH[2], 0, 0])
    np.testing.assert_allclose(reading, expected, rtol=0, atol=STEADY)


def test_calibration_by_the_inverse_takes_cross_talk_out(blocks):
    p, _ = blocks
    gain = np.eye(6) + 0.05 * RNG.normal(size=(6, 6))
    p["gain"], p["calibration"] = gain, np.linalg.inv(gain)
    start(blocks, WRENCH)
    np.testing.assert_allclose(sample(blocks, WRENCH)[1], WRENCH, rtol=0, atol=STEADY)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_beyond_its_range_the_signal_stays_at_the_end_and_says_so(blocks, sign):
    p, _ = blocks
    p["range"] = 100.0
    start(blocks, np.zeros(6))
    assert sample(blocks, np.zeros(6))[0]
    heavy = np.array([0.0, 0.0, sign * 900.0, 0.0, 0.0, 0.0])
    start(blocks, heavy)
    inside, reading = sample(blocks, heavy)
    assert not inside
    np.testing.assert_allclose(reading, [0, 0, sign * 100.0, 0, 0, 0], rtol=0, atol=STEADY)


def test_a_wrench_that_is_not_a_number_is_out_of_range(blocks):
    start(blocks, np.zeros(6))
    assert not sample(blocks, np.full(6, np.nan))[0]


def test_the_zero_is_subtracted(blocks):
    _, s = blocks
    s["zero"] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    start(blocks, WRENCH)
    np.testing.assert_allclose(
        sample(blocks, WRENCH)[1], WRENCH - [1, 2, 3, 4, 5, 6], rtol=0, atol=STEADY
    )


def test_counts_round_the_signal(blocks):
    p, _ = blocks
    p["resolution"] = 0.5
    start(blocks, WRENCH + 0.2)
    np.testing.assert_array_equal(sample(blocks, WRENCH + 0.2)[1], WRENCH)


def test_drift_grows_with_time(blocks):
    p, _ = blocks
    p["drift"] = 1e-3
    p["numerator"], p["denominator"] = [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]
    _, reading = sample(blocks, WRENCH, time=100.0)
    np.testing.assert_allclose(reading, WRENCH + 0.1, rtol=0, atol=STEADY)


def test_white_noise_enters_before_the_filter(blocks):
    p, _ = blocks
    p["noise"] = 2.0
    start(blocks, np.zeros(6))
    _, reading = sample(blocks, np.zeros(6), white=np.ones(6, np.float32))
    np.testing.assert_allclose(reading, 2.0 * p["numerator"][0, 0], rtol=1e-12)


def test_the_slow_noise_keeps_its_standard_deviation(blocks):
    """Gauss-Markov: sd stays, one step's correlation is the decay."""
    p, s = blocks
    decay = 0.9
    p["wander"], p["wander_decay"], p["wander_kick"] = 0.5, decay, np.sqrt(1 - decay**2)
    slow = np.random.default_rng(12).normal(size=(20000, 6)).astype(np.float32)
    start(blocks, np.zeros(6), wander=slow[0])
    series = np.empty((len(slow) - 1, 6))
    for i, row in enumerate(slow[1:]):
        force_sensor.wander_on(p[0], s[0], row)
        series[i] = s["wander"][0]
    # 120 000 samples, 6000 of them independent: sd to 1 %, four sigma
    assert abs(np.std(series) - 0.5) < 0.5 * 0.04
    assert abs(np.mean(series[1:] * series[:-1]) / np.var(series) - decay) < 0.01


def test_the_slow_noise_adds_to_the_signal(blocks):
    _, s = blocks
    start(blocks, WRENCH)
    s["wander"] = 0.25
    for _ in range(3000):  # 1 s: the low-pass has settled
        _, reading = sample(blocks, WRENCH)
    np.testing.assert_allclose(reading, WRENCH + 0.25, rtol=0, atol=1e-8)


def test_a_signal_at_the_end_of_its_range_is_within_it(blocks):
    p, _ = blocks
    p["numerator"] = p["denominator"] = [1.0, 0.0, 0.0]  # no low-pass, whose sum would round
    p["range"] = np.abs(WRENCH)
    assert sample(blocks, WRENCH)[0]
    p["range"] = np.nextafter(np.abs(WRENCH), 0.0)
    assert not sample(blocks, WRENCH)[0]


def test_six_axes_are_read_and_one_sensors_state_is_written(blocks):
    """What lies behind a vector is another's; compiled code checks no bounds."""
    p, _ = blocks
    for name in ("gain", "offset", "drift", "wander", "noise", "calibration"):
        p[name] = RNG.normal(size=p[name].shape)
    s = np.zeros(2, force_sensor.STATE)
    wrench, white = np.full(12, np.nan), np.full(12, np.nan, np.float32)
    wrench[:6], white[:6] = WRENCH, 1.0
    force_sensor.start_at(p[0], s[0], wrench[:6], white[:6])
    force_sensor.wander_on(p[0], s[0], white[:6])
    force_sensor.sample_wrench(p[0], s[0], wrench[:6], 1.0, white[:6])
    for name in force_sensor.STATE.names:
        assert np.all(np.isfinite(s[name][0])), name
        assert np.all(s[name][1] == 0.0), name
