"""Noise becomes white with unit variance, whatever it was."""

from __future__ import annotations

import numpy as np
import pytest
from pendulum import PLANT, STEP, fed
from scipy.signal import lfilter
from toy import Toy, programme

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.adequacy import cells, misfit, misfit_floor
from ves_twin.diagnosis.grid import AnalysisGrid
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.whitening import whitening_declared, whitening_measured


@pytest.fixture(scope="module")
def runs():
    return Runs(PLANT, (fed(np.zeros(4000)),), (0, 1))


def noise(seed: int, rows: int = 4000) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((rows, 2)) * [0.001, 0.01]


def test_declared_noise_is_white_behind_the_anti_alias_filter(runs):
    whitening = whitening_declared(runs)
    draws = [whitening.apply(runs.grids[0].reduce(noise(s))) for s in range(40)]
    # 40 draws of 1560 samples: the mean square scatters by sqrt(2 / 62400) = 0.6 %
    assert np.mean(np.square(draws)) == pytest.approx(1.0, abs=0.02)
    scores = np.array([[c.score() for c in cells(whitening, z)] for z in draws])
    assert np.abs(scores.mean(0)).max() < 4.5 / np.sqrt(40)
    assert scores.std() == pytest.approx(1.0, abs=0.1)
    worst = sorted(misfit(cells(whitening, z)) for z in draws)
    assert worst[35] < misfit_floor(scores.shape[1], 0.002)


def test_a_stack_of_no_shapes_is_whitened_to_no_shapes(runs):
    whitening = whitening_declared(runs)
    rows = runs.slices[0].stop
    one, none = (whitening.apply(np.zeros((n, rows, 2), np.float32)) for n in (1, 0))
    assert none.shape == (0, one.shape[1])


def test_correlated_coloured_noise_is_learnt_from_a_standstill():
    time = 0.01 * np.arange(6000)
    runs = Runs(Toy(), (programme(),), (0, 1))

    def shaped(seed):
        white = np.random.default_rng(seed).standard_normal((6000, 2))
        mixed = white @ np.array([[1.0, 0.6], [0.0, 0.8]])
        return lfilter([1.0], [1.0, -0.6, 0.2], mixed, axis=0) * [0.003, 0.4] + [5.0, -2.0]

    still = Recording(
        time, {"drive.u": np.zeros((6000, 1)), "out": shaped(1)}, RecordingInfo("measured")
    )
    whitening = whitening_measured(runs, still)
    z = whitening.apply((shaped(2) - [5.0, -2.0])[:800].astype(np.float32))
    block = whitening.blocks(z)[0]
    assert np.cov(block.T) == pytest.approx(np.eye(2), abs=0.15)  # 790 rows: 3 sd of 5 %
    lagged = np.array([np.mean(block[k:] * block[:-k], axis=0) for k in range(1, 6)])
    assert np.abs(lagged).max() < 3.5 / np.sqrt(len(block))


def test_drawn_noise_is_what_the_whitening_takes_as_white(runs):
    whitening = whitening_declared(runs)
    z = whitening.apply(whitening.draw(np.random.default_rng(0), 1.0, 0.0))
    assert np.mean(z**2) == pytest.approx(1.0, abs=0.11)  # 3 sd of sqrt(2 / 1562)
    louder = whitening.apply(whitening.draw(np.random.default_rng(0), 1.3, 0.2))
    adapted = whitening.adapted(louder)
    assert adapted.level[0] == pytest.approx([1.3, 1.3], rel=0.12)
    assert adapted.colour[0] == pytest.approx([0.2, 0.2], abs=0.2)


def test_a_short_or_slow_standstill_is_refused(runs):
    time = STEP * np.arange(300)
    signals = {"joint.angle": np.zeros((300, 1)), "joint.rate": np.zeros((300, 1))}
    with pytest.raises(InvalidInputError, match="standstill rows"):
        whitening_measured(runs, Recording(time, signals, RecordingInfo("measured")))
    with pytest.raises(InvalidInputError, match="standstill period"):
        whitening_measured(runs, Recording(10 * time, signals, RecordingInfo("measured")))


def test_the_grid_keeps_what_is_slow_and_drops_what_would_fold_back():
    grid = AnalysisGrid.of(0.002)
    assert grid.step == pytest.approx(0.01)
    time = 0.002 * np.arange(5000)
    slow = np.sin(2 * np.pi * 8.0 * time)[:, None]
    kept = grid.reduce(slow)[:, 0]
    assert kept == pytest.approx(np.sin(2 * np.pi * 8.0 * grid.times(time)), abs=0.01)
    folding = np.sin(2 * np.pi * 92.0 * time)[:, None]  # would come back as 8 Hz
    assert np.abs(grid.reduce(folding)).max() < 0.01
