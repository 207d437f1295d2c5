"""The length transducer: home plus slide plus noise, in whole counts."""

import numpy as np

from ves_twin.plant.physics import transducer

COUNT = 5e-6
ROUND_OFF = 1e-15
"""m, of lengths of 1 m."""
RNG = np.random.default_rng(10)
HOME = RNG.uniform(0.9, 1.1, 6)


def read(slide, noise=0.0, resolution=0.0, normal=None):
    p = np.zeros(1, transducer.PARAMETERS)
    p["home"], p["noise"], p["resolution"] = HOME, noise, resolution
    p["scale"] = 1.0
    length = np.empty(6)
    normal = np.zeros(6, np.float32) if normal is None else normal
    transducer.read_lengths(p[0], slide, normal, length)
    return length


def test_without_noise_and_counts_the_reading_is_the_length():
    slide = RNG.uniform(-0.2, 0.2, 6)
    np.testing.assert_array_equal(read(slide), HOME + slide)


def test_a_reading_is_the_nearest_whole_count():
    for slide in RNG.uniform(-0.2, 0.2, (200, 6)):
        length = read(slide, resolution=COUNT)
        counts = length / COUNT
        np.testing.assert_allclose(counts, np.round(counts), rtol=0, atol=1e-9)
        assert np.max(np.abs(length - HOME - slide)) <= COUNT / 2 + ROUND_OFF


def test_rounding_is_not_the_identity():
    slide = np.full(6, COUNT / 3)
    assert np.max(np.abs(read(slide, resolution=COUNT) - HOME - slide)) > COUNT / 100


def test_noise_enters_by_its_standard_deviation():
    normal = np.array([1.0, -2.0, 0.5, 0.0, 3.0, -1.0], np.float32)
    length = read(np.zeros(6), noise=1e-5, normal=normal)
    np.testing.assert_allclose(length - HOME, 1e-5 * normal.astype(float), rtol=0, atol=ROUND_OFF)
