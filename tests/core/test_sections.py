"""Sections of second order against scipy.signal, which a run has no time to import."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.signal import butter, cheby2, lfilter

from ves_twin.core.sections import butterworth, chebyshev, passed

RUN = """
import sys
import ves_twin as vt
vt.simulate(vt.Scenario.load("position_sine", {"run.duration": 0.05, "run.settle": 0.05}))
print({"pandas", "scipy.signal", "scipy.stats", "matplotlib"} & set(sys.modules))
"""


@pytest.mark.parametrize("at", [1.5, 9.0, 20.0, 200.0])
@pytest.mark.parametrize("rate", [587.0, 1.0 / 341e-6, 4.0 / 341e-6])
def test_sections_are_those_of_scipy(at, rate):
    lower = butter(2, at, fs=rate)
    answer = lfilter(*lower, np.eye(1, int(rate))[0])
    np.testing.assert_allclose(passed(at, rate), np.sqrt(np.sum(answer**2)), rtol=1e-13)
    pairs = (butterworth(at, rate), lower), (chebyshev(at, 4.0, rate), cheby2(2, 4.0, at, fs=rate))
    for ours, theirs in pairs:
        np.testing.assert_allclose(ours, theirs, rtol=1e-13)


def test_a_run_imports_no_slow_package_that_it_does_not_need():
    done = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
