"""Rows are handed over beside the run: each once, to the sink that it was meant for."""

import threading

import numpy as np

import ves_twin as vt
from ves_twin.simulator.recorder import BUFFER_SECONDS, MemorySink, Recorder

CHANGES = {"run.duration": 2.5 * BUFFER_SECONDS, "run.settle": 0.1}


class Slow(MemorySink):
    """Takes no row before it may."""

    def __init__(self) -> None:
        super().__init__()
        self.may = threading.Event()

    def write(self, time, signals) -> None:
        self.may.wait(30.0)
        super().write(time, signals)


def test_rows_under_way_stay_with_the_sink_that_they_were_handed_to():
    first, second = Slow(), MemorySink()
    scenario = vt.Scenario.load("beam_horizontal_truth", CHANGES)
    sim = vt.Simulator(None, scenario, sink=first)
    sim.advance(1.5 * BUFFER_SECONDS)
    sim.recorder.sink = second
    first.may.set()
    sim.recorder.flush()
    before, after = first.collect()[0], second.collect()[0]
    assert len(before) > 0
    assert len(after) > 0
    assert before[-1] < after[0]
    np.testing.assert_allclose(np.diff(np.concatenate([before, after])), np.diff(before)[0])


def test_an_interrupt_in_the_last_of_a_run_loses_no_row(tmp_path, monkeypatch):
    """The run has ended by then; what it handed over beside is still written."""
    scenario = vt.Scenario.load("beam_horizontal_truth", CHANGES)
    whole = vt.simulate(scenario, seed=1)
    flush, left = Recorder.flush, [KeyboardInterrupt]

    def interrupted(self: Recorder, unfinished: bool = False) -> None:
        if left:
            raise left.pop()
        flush(self, unfinished)

    monkeypatch.setattr(Recorder, "flush", interrupted)
    vt.record(scenario, tmp_path / "run", seed=1)
    assert not left
    found = vt.load_recording(tmp_path / "run")
    np.testing.assert_array_equal(found.time, whole.time)
