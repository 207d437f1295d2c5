"""How well `fast` agrees with `full`, scenario by scenario, and how much faster it is.

Run by `make fidelity`, which writes the tables of docs/fidelity.md between its marks. Speed is the
ratio of wall-clock times of the two simulators, advanced in turn in one process.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import mujoco
import numpy as np

import ves_twin as vt
from ves_twin.scenario.load import scenario_questions
from ves_twin.simulator.emulation_error import emulation_error
from ves_twin.simulator.recorder import NoSink

PIECE = 0.25
"""Simulated time between two changes from the one to the other [s]."""

PIECES = 8
"""Pieces of each simulator in a round."""

LINE_SECONDS, VIBRATES = 4.0, 20.0
"""A run vibrates if its last seconds have a line above 5 Hz of more than this [N]."""

GAINS = {"beam_horizontal_truth": (12.6, 14.0, 16.0), "beam_vertical_truth": (10.0, 12.6, 14.0)}
"""Leg gains about the limit of stability."""

BEGIN, END = "<!-- measured: make fidelity -->", "<!-- end -->"

POSES = ("truth.pose", "reference.pose", "reference.pose_leg_lag")


@dataclass(frozen=True)
class Pair:
    """One scenario in both fidelities."""

    name: str
    full: vt.Recording
    fast: vt.Recording

    def differences(self, signal: str, columns: slice, unit: float) -> str:
        """Rms and peak over the common rows: largest axis of a group, in units of `unit`."""
        rows = min(len(self.full), len(self.fast))
        gap = self.fast[signal][:rows, columns] - self.full[signal][:rows, columns]
        rms, peak = np.sqrt(np.mean(gap**2, axis=0)).max(), np.abs(gap).max()
        return f"{rms / unit:.3g} / {peak / unit:.3g}"

    def emulation_errors(self, columns: slice, unit: float) -> str:
        """Rms emulation error of full and fast, the axis where full has the largest."""
        if "reference.pose" not in self.full.signals:
            return "-"
        errors = []
        for run in (self.full, self.fast):
            found = emulation_error([tuple(run[name] for name in POSES)])
            errors.append([error.rms / unit for error in found.values()][columns])
        worst = int(np.argmax(errors[0]))
        return f"{errors[0][worst]:.3g}, {errors[1][worst]:.3g}"

    def row(self) -> str:
        """A line of the table."""
        move, turn = slice(0, 3), slice(3, 6)
        ends = f"{self.full.info.outcome} {self.full.time[-1]:.1f} s"
        if (self.full.info.outcome, len(self.full)) != (self.fast.info.outcome, len(self.fast)):
            ends += f"; fast {self.fast.info.outcome} {self.fast.time[-1]:.1f} s"
        cells = [
            f"`{self.name}`",
            ends,
            self.differences("truth.pose", move, 1e-3),
            self.differences("truth.pose", turn, 1e-3),
            self.differences("sensor.wrench", move, 1.0),
            self.differences("sensor.wrench", turn, 1.0),
            self.emulation_errors(move, 1e-3),
            self.emulation_errors(turn, 1e-3),
        ]
        return "| " + " | ".join(cells) + " |"


def pair(name: str) -> Pair:
    """Run a scenario in both fidelities, same seed and so the same noise."""
    scenario = vt.Scenario.load(name)
    plant = vt.Plant.load(scenario.plant)
    full, fast = (vt.simulate(scenario, plant.with_fidelity(f)) for f in ("full", "fast"))
    return Pair(name, full, fast)


def highest_line(run: vt.Recording) -> tuple[float, float]:
    """Largest line of the sensor's force above 5 Hz in the last seconds: [Hz], [N]."""
    tail = run["sensor.wrench"][-int(LINE_SECONDS / run.info.period) :, :3]
    window = np.hanning(len(tail))[:, None]
    lines = np.abs(np.fft.rfft((tail - tail.mean(axis=0)) * window, axis=0)).max(axis=1)
    frequency = np.fft.rfftfreq(len(tail), run.info.period)
    lines[frequency < 5.0] = 0.0
    at = int(np.argmax(lines))
    return float(frequency[at]), float(lines[at] * 4.0 / len(tail))


def gain_row(name: str, gain: float) -> str:
    """How a scenario ends at a leg gain, and at which frequency it vibrates, full and fast."""
    cells = [f"`{name}`", f"{gain:g}"]
    for plant in ("ves2", "ves2_fast"):
        changes = {"plant": plant, "legs.gain": gain, "run.duration": 20.0}
        run = vt.simulate(vt.Scenario.load(name, changes))
        frequency, size = highest_line(run)
        vibrates = f"{frequency:.1f} Hz" if size > VIBRATES else "no vibration"
        cells.append(f"{run.info.outcome} {run.time[-1]:.1f} s, {vibrates}")
    return "| " + " | ".join(cells) + " |"


def twins(references: bool) -> list[vt.Simulator]:
    """The beam scenario in full and in fast, ready to run on."""
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 1e6})
    sims = [vt.Simulator(vt.Plant.load(p), scenario, sink=NoSink()) for p in ("ves2", "ves2_fast")]
    for sim in sims:
        if not references:
            sim.recorder.drop_references()
    return sims


def ratios(rounds: int) -> dict[str, list[float]]:
    """Time of full over time of fast, a number a round, for what is timed."""

    def step(sim: vt.Simulator) -> None:
        mujoco.mj_step(sim.model, sim.data, sim.rig.clock.ticks(PIECE))

    def advance(sim: vt.Simulator) -> None:
        sim.advance(PIECE)

    cases: list[tuple[str, Callable[[vt.Simulator], None], list[vt.Simulator]]] = [
        ("bare `mj_step`", step, twins(references=False)),
        ("closed loop, no zero-g reference", advance, twins(references=False)),
        ("closed loop with both zero-g references", advance, twins(references=True)),
    ]
    found: dict[str, list[float]] = {what: [] for what, _, _ in cases}
    for _ in range(rounds):
        for what, action, sims in cases:
            times = [0.0, 0.0]
            for piece in range(2 * PIECES):
                begin = perf_counter()
                action(sims[piece % 2])
                times[piece % 2] += perf_counter() - begin
            found[what].append(times[0] / times[1])
    return found


def report(rounds: int) -> str:
    """The tables as Markdown."""
    lines = [
        "| scenario | ends | pose, mm | pose, mrad | wrench, N | wrench, N m"
        " | error full, fast, mm | mrad |",
        "|---|---|--:|--:|--:|--:|--:|--:|",
    ]
    for name in scenario_questions():
        lines.append(pair(name).row())
    lines += [
        "",
        "| scenario, 20 s | `legs.gain`, 1/s | full | fast |",
        "|---|--:|---|---|",
        *(gain_row(name, gain) for name, gains in GAINS.items() for gain in gains),
    ]
    lines += ["", "| what is timed | full over fast, median | 5 % | 95 % |", "|---|--:|--:|--:|"]
    for what, values in ratios(rounds).items():
        cuts = statistics.quantiles(values, n=20)
        lines.append(
            f"| {what} | {statistics.median(values):.2f} | {cuts[0]:.2f} | {cuts[-1]:.2f} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Print the tables, or write them into a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", nargs="?", type=Path)
    parser.add_argument("--rounds", type=int, default=20)
    arguments = parser.parse_args()
    text = report(arguments.rounds)
    print(text)
    if arguments.page:
        page = arguments.page.read_text(encoding="utf-8")
        before, after = page.split(BEGIN)[0], page.split(END)[1]
        arguments.page.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
