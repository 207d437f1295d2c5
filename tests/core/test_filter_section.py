"""Sections of the loops are scipy's, at the rates that rigs have."""

import numpy as np
import pytest
from scipy.signal import butter, cheby2, lfilter

from ves_twin.core.filter_section import butterworth, chebyshev, impulse_response

ROUND_OFF = 1e-12
"""Versions of scipy take the roots by other formulas; the pinned one is met to the last bit."""


@pytest.mark.parametrize("rate", [500.0, 587.0, 2941.0, 3003.0])
def test_sections_and_impulse_are_those_of_scipy(rate):
    for corner in np.random.default_rng(0).uniform(1.0, 0.49 * rate, 50):
        expected = butter(2, corner, fs=rate)
        found = butterworth(corner, rate)
        np.testing.assert_allclose(found, expected, rtol=ROUND_OFF)
        impulse = lfilter(*expected, np.eye(1, 300)[0])
        np.testing.assert_array_equal(impulse_response(expected, 300), impulse)
        notched = cheby2(2, 4.0, corner, fs=rate)
        np.testing.assert_allclose(chebyshev(4.0, corner, rate), notched, rtol=ROUND_OFF)
