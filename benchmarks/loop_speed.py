"""Closed loop against bare mj_step on the same model, interleaved in one process.

Run by `make bench`. Prints the median over rounds of (processor time of bare mj_step) / (that of
the closed loop, its threads included): 1.00 means that control, hydraulics, sensor chain and
logging to disk cost nothing.
"""

from __future__ import annotations

import argparse
import copy
import statistics
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import mujoco

import ves_twin as vt
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.simulator.recorder import NoSink
from ves_twin.simulator.simulate import recording_info

PIECE = 0.5
"""Simulated time between two changes from the one to the other [s]."""

PIECES = 8
"""Pieces of a round: one filling of the recorder's buffer, so that each round writes once."""


def ratios(log: str, references: bool, rounds: int, folder: Path) -> tuple[list[float], float]:
    """Ratio of each round, and how much faster than real time the closed loop ran."""
    changes = {"run.log": log, "run.duration": 1e6}
    scenario = vt.Scenario.load("beam_horizontal_truth", changes)
    sim = vt.Simulator(None, scenario, sink=NoSink())
    if not references:
        sim.recorder.drop_references()
    stream = RecordingStream(folder, sim.recorder.names, recording_info(sim))
    sim.recorder.sink = stream
    steps = sim.rig.clock.ticks(PIECE)
    sim.advance(PIECE * PIECES)
    found, all_loops = [], 0.0
    for _ in range(rounds):
        bare = loop = 0.0
        for _ in range(PIECES):
            data = copy.copy(sim.data)
            begin = process_time()
            mujoco.mj_step(sim.model, data, steps)
            middle, clock = process_time(), perf_counter()
            sim.advance(PIECE)
            bare, loop = bare + middle - begin, loop + process_time() - middle
            all_loops += perf_counter() - clock
        found.append(bare / loop)
    stream.close()
    return found, rounds * PIECES * PIECE / all_loops


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    rounds = parser.parse_args().rounds
    print("logging     zero-g reference     ratio     5 %    95 %  x real time")
    for log in ("admittance", "leg", "tick"):
        for references in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                found, speed = ratios(log, references, rounds, Path(folder))
            cuts = statistics.quantiles(found, n=20)
            print(
                f"{log:<12}{'yes' if references else 'no':<18}{statistics.median(found):8.3f}"
                f"{cuts[0]:8.3f}{cuts[-1]:8.3f}{speed:13.1f}"
            )


if __name__ == "__main__":
    main()
