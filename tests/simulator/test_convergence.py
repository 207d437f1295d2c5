"""The result converges in the physics sub-step while the controllers keep their clocks."""

import numpy as np
import pytest

import ves_twin as vt

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def runs(request: pytest.FixtureRequest) -> dict[int, np.ndarray]:
    """Base motion of 5 s of the beam, by night 8 s, at 1, 2 and 4 sub-steps a tick."""
    seconds = 8.0 if request.config.getoption("--nightly") else 5.0
    found = {}
    for substeps in (1, 2, 4):
        changes = {"run.duration": seconds, "run.substeps": substeps}
        found[substeps] = vt.simulate(vt.Scenario.load("beam_horizontal_truth", changes))[
            "truth.pose"
        ]
    return found


def test_halving_the_substep_changes_the_base_motion_by_less_than_a_percent(runs, figure):
    for part, name in ((slice(0, 3), "translation"), (slice(3, 6), "rotation")):
        peak = np.max(np.linalg.norm(runs[1][:, part], axis=1))
        change = np.max(np.linalg.norm(runs[1][:, part] - runs[2][:, part], axis=1))
        figure(f"beam: change of {name} on halving the sub-step", change / peak * 100, 1.0, "%")


def test_error_falls_with_the_substep(runs):
    first = np.max(np.abs(runs[1][:, :3] - runs[2][:, :3]))
    second = np.max(np.abs(runs[2][:, :3] - runs[4][:, :3]))
    assert second < 0.75 * first  # first order would halve it; noise enters at the same ticks
