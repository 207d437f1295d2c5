"""Noise is a function of seed, channel and tick alone."""

import subprocess
import sys

import numpy as np

from ves_twin.simulator.codes import FAST_CHANNELS, SLOW, SLOW_CHANNELS
from ves_twin.simulator.noise import BLOCK, ORIGIN, NoiseStreams


def test_a_tick_has_the_same_number_whatever_was_asked_before():
    one, two = NoiseStreams(5), NoiseStreams(5)
    one.window(-7000, 37)
    one.window(3 * BLOCK, 37)
    for tick in (-7000, -1, 0, BLOCK - 10, BLOCK, 5 * BLOCK + 3):
        fast_one, slow_one = one.window(tick, 37)
        fast_two, slow_two = two.window(tick, 37)
        assert np.array_equal(fast_one, fast_two)
        assert np.array_equal(slow_one[:3], slow_two[:3])


def test_windows_join_without_a_seam():
    streams = NoiseStreams(5)
    start = BLOCK - 20
    whole = streams.window(start, 40)[0].copy()
    parts = [streams.window(start + k, 1)[0].copy() for k in range(40)]
    assert np.array_equal(whole, np.vstack(parts))


def test_slow_rows_change_once_in_sixteen_ticks():
    streams = NoiseStreams(5)
    first = streams.window(0, 1)[1][0].copy()
    assert np.array_equal(first, streams.window(SLOW - 1, 1)[1][0])
    assert not np.array_equal(first, streams.window(SLOW, 1)[1][0])


def test_channels_and_seeds_are_independent_and_standard_normal():
    numbers = NoiseStreams(5).window(0, BLOCK)[0].T.copy()
    other = NoiseStreams(6).window(0, BLOCK)[0].T
    spread = 5.0 / np.sqrt(BLOCK)  # five standard errors of a correlation of nothing
    correlation = np.corrcoef(numbers)
    assert np.max(np.abs(correlation - np.eye(FAST_CHANNELS))) < spread
    assert abs(np.corrcoef(numbers[0], other[0])[0, 1]) < spread
    assert np.allclose(numbers.std(axis=1), 1.0, atol=5.0 / np.sqrt(2 * BLOCK))


def test_every_channel_is_the_philox_stream_of_its_own_key():
    seed, block = 2**63 - 2, 3
    fast, slow = NoiseStreams(seed).window(block * BLOCK - ORIGIN, 1 + SLOW)
    for channel in range(FAST_CHANNELS + SLOW_CHANNELS):
        bits = np.random.Philox(key=[seed, channel], counter=[0, block, 0, 0])
        wanted = np.random.Generator(bits).standard_normal(BLOCK, np.float32)
        found = fast[:, channel] if channel < FAST_CHANNELS else slow[:, channel - FAST_CHANNELS]
        assert np.array_equal(found[:17], wanted[:17])


def test_noise_off_is_zero():
    fast, slow = NoiseStreams(5, enabled=False).window(100, 37)
    assert not fast.any()
    assert not slow.any()


FORKED = """
import os, sys
import subprocess
import sys

import numpy as np
import ves_twin as vt
from ves_twin.simulator.simulator import Simulator

sim = Simulator(None, vt.Scenario.load("position_sine", {"run.duration": 6.0, "run.settle": 0.3}))
sim.advance(0.5)
child = os.fork()
sim.advance(5.0)  # several blocks of noise
said = sim.rig.board.row.tobytes()
if child == 0:
    with open(sys.argv[1], "wb") as file:
        file.write(said)
    os._exit(0)
os.waitpid(child, 0)
with open(sys.argv[1], "rb") as file:
    assert file.read() == said, "the child went another way"
"""


def test_a_simulator_goes_on_in_a_forked_process(tmp_path):
    """It once waited there for ever, for a thread that a fork does not copy."""
    words = [sys.executable, "-c", FORKED, str(tmp_path / "child")]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
