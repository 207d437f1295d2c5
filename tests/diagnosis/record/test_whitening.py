"""Noise becomes white with unit variance, whatever it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pendulum import PLANT, STEP, fed
from scipy.signal import lfilter
from toy import ROWS, SD, Toy, programme

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.grid import AnalysisGrid
from ves_twin.diagnosis.record.adequacy import cells, misfit, misfit_floor
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import (
    FEWEST,
    ORDER,
    _periodogram,
    whitening_declared,
    whitening_measured,
)


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


def toy_runs(hole=None) -> Runs:
    """Of a plant whose channels have a grid of the recording's own rate and white noise."""
    holes = () if hole is None else (hole,)
    return Runs(Toy(), (programme(),), (0, 1), holes=holes)


def white(seed: int, rows: int = ROWS) -> np.ndarray:
    noise = np.random.default_rng(seed).standard_normal((rows, 2)) * SD
    return noise.astype(np.float32)


def still(values: np.ndarray, period: float = 0.01) -> Recording:
    signals = {"drive.u": np.zeros((len(values), 1)), "out": values}
    return Recording(period * np.arange(len(values)), signals, RecordingInfo("measured"))


def test_a_line_in_the_standstill_is_no_noise():
    line = np.linspace(-1.0, 1.0, 4000)[:, None] * [7.0, -30.0] + [5.0, -2.0]
    noise = white(1, 4000).astype(float)
    plain, added = (whitening_measured(toy_runs(), still(x)) for x in (noise, noise + line))
    # the grid is in single precision: 1e-7 of lines 600 times the noise
    np.testing.assert_allclose(added.mixing, plain.mixing, rtol=1e-3)
    np.testing.assert_allclose(added.filters, plain.filters, atol=1e-3)


@pytest.mark.parametrize(("share", "told"), [(0.7e-3, False), (1.5e-3, True)])
def test_a_channel_below_a_thousandth_of_its_declared_power_tells_nothing(share, told):
    noise = white(1, 4000) * [1.0, np.sqrt(share)]
    found = whitening_measured(toy_runs(), still(noise))
    sd = 1.0 / found.mixing[0, 1, 1]
    expected = SD[1] * (np.sqrt(share) if told else 1.0)
    assert sd == pytest.approx(expected, rel=0.08)  # 4000 rows: 3 sd of 1.1 %, and the mixing


@pytest.mark.parametrize(("ratio", "right"), [(1.009, True), (1.011, False), (0.989, False)])
def test_a_standstill_has_the_rate_of_the_recordings_to_a_percent(ratio, right):
    if right:
        assert whitening_measured(toy_runs(), still(white(1, 400), 0.01 * ratio)).measured
    else:
        with pytest.raises(InvalidInputError, match="standstill period"):
            whitening_measured(toy_runs(), still(white(1, 400), 0.01 * ratio))


@pytest.mark.parametrize("left", [FEWEST, FEWEST - 1])
def test_a_standstill_mixes_channels_only_where_enough_samples_are_whole(left):
    hole = np.zeros((ROWS, 2), bool)
    hole[: ROWS - left - ORDER - 1, 0] = True  # a sample rests on so many rows before it
    runs = toy_runs(hole)
    if left >= FEWEST:
        assert whitening_measured(runs, still(white(1, 400))).measured
    else:
        with pytest.raises(InvalidInputError, match="between the holes"):
            whitening_measured(runs, still(white(1, 400)))


def test_a_hole_of_one_channel_is_one_of_all_only_where_they_are_mixed():
    hole = np.zeros((ROWS, 2), bool)
    hole[100:200, 0] = True
    own = whitening_declared(toy_runs(hole))
    mixed = replace(own, mixing=own.mixing + np.array([[0.0, 0.0], [1.0, 0.0]]))
    apart, together = (w.blocks(w.weights)[0] for w in (own, mixed))
    lost = 100 + ORDER + 1
    assert np.array_equal(ROWS - ORDER - 1 - apart.sum(axis=0), [lost, 0])
    assert np.array_equal(ROWS - ORDER - 1 - together.sum(axis=0), [lost, lost])
    assert np.array_equal(own.freedom, own.weights)
    assert np.all(own.apply(white(3))[own.weights == 0.0] == 0.0)


def test_without_holes_every_sample_counts():
    declared = whitening_declared(toy_runs())
    assert declared.weights is None
    assert np.array_equal(declared.freedom, np.ones(2 * (ROWS - ORDER - 1)))


def test_the_level_that_a_record_shows_is_of_the_samples_that_count():
    hole = np.zeros((ROWS, 2), bool)
    hole[:400] = True
    rows = 1.2 * white(4)
    for runs in (toy_runs(), toy_runs(hole)):
        declared = whitening_declared(runs)
        own = declared.adapted(declared.apply(rows))
        # 400 rows of which two thirds of the spectrum are taken: 3 sd of 4 %
        assert own.level[0] == pytest.approx([1.2, 1.2], rel=0.13)
        assert declared.floor(declared.apply(rows)) == 1.0


@pytest.mark.parametrize("colour", [-0.25, 0.0, 0.3])
def test_the_colour_that_a_long_record_shows_is_its_own(colour):
    time = 0.01 * np.arange(8000)
    long = Runs(Toy(), (Excitation("long", time, {"drive.u": np.zeros((8000, 1))}),), (0, 1))
    declared = whitening_declared(long)
    z = declared.apply(declared.draw(np.random.default_rng(2), 1.1, colour))
    own = declared.adapted(z)
    # two thirds of 8000 samples: 3 sd of 1.4 %, and a step of the grid
    assert own.colour[0] == pytest.approx([colour] * 2, abs=0.05)
    assert own.level[0] == pytest.approx([1.1, 1.1], rel=0.04)


def test_what_was_adapted_stays_when_it_is_adapted_again():
    declared = whitening_declared(toy_runs())
    rows = 1.3 * white(5)
    own = declared.adapted(declared.apply(rows))
    again = own.adapted(own.apply(rows))
    assert again.level == pytest.approx(own.level, rel=0.02)
    assert again.colour == pytest.approx(own.colour, abs=0.03)  # a step of the grid: 0.025


@pytest.mark.parametrize(
    ("share", "taken"), [(0.0, False), (0.29, False), (0.31, True), (0.97, True), (1.0, False)]
)
def test_noise_is_told_between_the_motion_and_half_the_rate_of_the_grid(share, taken):
    """A tone at a share of the Nyquist rate, with a whole number of periods."""
    tone = np.cos(share * np.pi * np.arange(800))[:, None]
    power, angle = _periodogram(tone)
    assert power.shape == (len(angle), 1)
    if taken:
        # Parseval: n / 4 in the one bin at the tone's angle
        assert angle[np.argmax(power)] == pytest.approx(share * np.pi)
        assert power.max() == pytest.approx(200.0)
    else:
        assert power.max() < 1e-9


def test_poses_at_rest_have_noise_without_memory_and_lose_no_row():
    rest = Runs(Toy(), (replace(programme(), poses=True),), (0, 1))
    declared = whitening_declared(rest)
    rows = 1.2 * white(7)
    z = declared.apply(rows)
    np.testing.assert_allclose(z.reshape(-1, 2), rows / np.array(SD), rtol=1e-5)
    assert len(declared.times()[0]) == len(declared.blocks(z)[0]) == len(declared.freedom) / 2
    own = declared.adapted(z)
    assert np.abs(own.colour).max() < 1e-15
    assert own.level[0] == pytest.approx([1.2, 1.2], rel=0.09)  # 540 of 800: 3 sd of 3 %
    drawn = declared.apply(declared.draw(np.random.default_rng(1), 1.0, 0.4)).reshape(-1, 2)
    assert np.mean(drawn**2) == pytest.approx(1.0, abs=0.11)  # 3 sd of sqrt(2 / 1600)
    # one rho of 1 / sqrt(1600) is 0.025
    assert abs(np.mean(drawn[1:] * drawn[:-1])) < 0.1
    hole = np.zeros((ROWS, 2), bool)
    hole[5, 0] = True
    weights = whitening_declared(replace(rest, holes=(hole,))).weights
    assert np.count_nonzero(weights == 0.0) == 1
