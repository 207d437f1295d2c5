"""Measures and writes the table of docs/teaching.md: thesis -> function -> command -> seconds.

    .venv/bin/python benchmarks/teaching.py docs/teaching.md

Seconds are of the processor (user and system, all processes of the command), which a busy machine
changes little; run it twice, since the first run compiles the inner loop.
"""

from __future__ import annotations

import resource
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

BEGIN, END = "<!-- table by benchmarks/teaching.py -->", "<!-- end -->"


@dataclass(frozen=True)
class Row:
    """One thing of the thesis: where it is computed, how it is run, which notebook has it."""

    thesis: str
    what: str
    function: str
    command: str
    notebook: int | None = None


ROWS = (
    Row(
        "eqs 2.4-2.6",
        "admittance model, sampled",
        "mechanics.emulated:EmulatedSystem",
        "reproduce C004 --no-cache",
        1,
    ),
    Row(
        "2.4.2",
        "an overrun halts the experiment",
        "simulator.clock:overrun",
        "run operation_overrun --no-rrd",
    ),
    Row(
        "eqs 3.3-3.9, D.1",
        "gravity model",
        "mechanics.gravity.gravity_model:GravityModel",
        "run beam_model_method --no-rrd",
        3,
    ),
    Row(
        "3.4",
        "47 poses identify payload and sensor",
        "mechanics.gravity.identify:identify",
        "run calibrate_47_poses",
    ),
    Row(
        "Table 3-1",
        "gravity model, verified",
        "procedures.gravity.verify_gravity:VerifyGravity",
        "run verify_gravity_model",
    ),
    Row(
        "3.2.2, Fig. 3-2",
        "what a wrong gravity does",
        "procedures.gravity.gravity_sensitivity:GravitySensitivity",
        "run gravity_sensitivity",
    ),
    Row(
        "3.3",
        "Learning Method",
        "procedures.emulation.learning_method:LearningMethod",
        "run beam_learning_method --set iterations=3 --set duration=6 --set alpha=5"
        " --set compare=false",
        3,
    ),
    Row(
        "eqs 4.1, 4.2",
        "virtual manipulator",
        "mechanics.planning.virtual_manipulator:VirtualManipulator",
        "reproduce C112 --no-cache",
    ),
    Row(
        "Fig. 4-1",
        "coupling map",
        "mechanics.planning.coupling_map:coupling_map",
        "reproduce fig-4-1 --no-cache",
        4,
    ),
    Row(
        "eq. 4.3",
        "arm on a flexible base",
        "mechanics.planning.flexible_base:FlexibleBaseArm",
        "reproduce fig-4-4 --no-cache",
        4,
    ),
    Row(
        "eq. 4.4",
        "damping estimator",
        "mechanics.planning.pped:damping_estimator",
        "reproduce fig-4-5 --no-cache",
        4,
    ),
    Row(
        "eqs 4.5, 4.6, Fig. 4-7",
        "PPED and high gains",
        "mechanics.planning.pped:search_gains",
        "reproduce fig-4-7 --no-cache",
        4,
    ),
    Row(
        "Table 5-1, Fig. 5-5",
        "leg filter",
        "control.leg_loop:chebyshev_section",
        "reproduce fig-5-5 --quick --no-cache",
        2,
    ),
    Row(
        "Fig. 5-12",
        "closed leg loop",
        "simulator.linear.leg_loop:leg_loop",
        "reproduce fig-5-12 --quick --no-cache",
        2,
    ),
    Row(
        "Fig. 5-13",
        "steps",
        "simulator.linear.response:step_response",
        "reproduce fig-5-13 --quick --no-cache",
        2,
    ),
    Row(
        "Figs 5-6, 5-8",
        "stability of the emulation",
        "simulator.linear.admittance_loop:admittance_loop",
        "reproduce fig-5-8 --quick --no-cache",
    ),
    Row(
        "Table 5-2, Fig. 5-11",
        "positioning error",
        "procedures.response.positioning_error:PositioningErrorTest",
        "reproduce fig-5-11 --quick --no-cache",
    ),
    Row(
        "Appendix A",
        "matrices of the beams",
        "mechanics.beams.beam:StraightBeam",
        "reproduce C104 --no-cache",
    ),
    Row(
        "Appendix E",
        "a session by the handbook",
        "control.operation.machine:Machine",
        "run operation_session --no-rrd",
    ),
)


def seconds(command: str, folder: Path) -> float:
    """Processor time of a command of ves-twin [s]; the file is whole or the command failed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [sys.executable, "-m", "ves_twin.cli.main", *shlex.split(command)]
    if words[3] == "run":
        words += ["--out", str(folder / words[4])]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{command}: {done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def line(row: Row, time: str) -> str:
    """A row of the table."""
    command = row.command.replace(" --no-cache", "").replace(" --no-rrd", "")
    notebook = "" if row.notebook is None else str(row.notebook)
    cells = (row.thesis, row.what, f"`{row.function}`", f"`{command}`", notebook, time)
    return "| " + " | ".join(cells) + " |"


def main(page: Path) -> None:
    """Measure every row and write the table into the page."""
    names = "| thesis | what | function | ves-twin | notebook | s |"
    head = [names, "|---|---|---|---|--:|--:|"]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for row in ROWS:
            rows.append(line(row, f"{seconds(row.command, Path(folder)):.0f}"))
            print(rows[-1], flush=True)
    text = page.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    table = "\n".join([BEGIN, "", *head, *rows, "", END])
    page.write_text(before + table + after, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
