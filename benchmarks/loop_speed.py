"""Closed loop against bare mj_step on the same model, interleaved in one process.

Run by `make bench`. Prints medians over rounds of (time of bare mj_step) / (time of the closed
loop): 1.00 means that control, hydraulics, sensor chain and logging to disk cost nothing. By the
clock is what a user waits where a second core is free; by the processors counts all threads.
"""

from __future__ import annotations

import argparse
import copy
import statistics
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

import mujoco
import numpy as np

import ves_twin as vt
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.simulator.recorder import NoSink
from ves_twin.simulator.simulate import recording_info

PIECE = 20.0
"""Simulated time of a round [s]: a run of this length, its last rows on disk."""


@dataclass(frozen=True)
class Times:
    """What a round took by the clock and by the processors [s] (2,)."""

    bare: np.ndarray
    loop: np.ndarray


def ratios(log: str, references: bool, rounds: int, folder: Path) -> tuple[list[Times], float]:
    """Times of each round, and how much faster than real time the closed loop ran."""
    changes = {"run.log": log, "run.duration": 1e6}
    scenario = vt.Scenario.load("beam_horizontal_truth", changes)
    sim = vt.Simulator(None, scenario, sink=NoSink())
    if not references:
        sim.recorder.drop_references()
    stream = RecordingStream(folder, sim.recorder.names, recording_info(sim))
    sim.recorder.sink = stream
    steps = sim.rig.clock.ticks(PIECE)
    sim.advance(PIECE)
    sim.recorder.flush()
    found = []
    for _ in range(rounds):
        data = copy.copy(sim.data)
        begin = _now()
        mujoco.mj_step(sim.model, data, steps)
        middle = _now()
        sim.advance(PIECE)
        sim.recorder.flush()  # no thread is at work for it while the other is measured
        found.append(Times(middle - begin, _now() - middle))
    stream.close()
    return found, rounds * PIECE / sum(times.loop[0] for times in found)


def _now() -> np.ndarray:
    """By the clock, and of the process [s] (2,)."""
    return np.array([perf_counter(), process_time()])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    rounds = parser.parse_args().rounds
    print("logging     references       clock  5 % to 95 %  processors  5 % to 95 %  x real time")
    for log in ("admittance", "leg", "tick"):
        for references in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                found, speed = ratios(log, references, rounds, Path(folder))
            print(f"{log:<12}{'yes' if references else 'no':<12}", end="")
            for k in range(2):
                of_rounds = [times.bare[k] / times.loop[k] for times in found]
                low, *_, high = statistics.quantiles(of_rounds, n=20)
                median = statistics.median(of_rounds)
                print(f"{median:12.3f}  {low:.3f} to {high:.3f}", end="")
            print(f"{speed:8.1f}")


if __name__ == "__main__":
    main()
