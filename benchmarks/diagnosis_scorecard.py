"""Blind suites of two plants, made, answered and marked; their page.

Run by `make diagnosis-scorecard`; an interrupted run goes on where it was.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

SUITES = {
    "pendulum": "--bench pendulum --none 200 --single 120 --outside 32 --pair 24 --confusable 24",
    "pendulum_loose": "--bench pendulum --none 80 --single 40 --outside 0 --pair 0 --spread 2.5",
    "ves2_fast": "--bench ves2_fast --none 4 --single 3 --outside 0 --pair 0",
}
"""Cases of each suite. One of VES II takes minutes, so they are few."""

SEED = 20261121

TITLES = {
    "pendulum": "pendulum",
    "pendulum_loose": "pendulum, commissioned 2.5 times worse than declared",
    "ves2_fast": "VES II, `fast`",
}

HEAD = """# Scorecard of the diagnosis

Written by `make diagnosis-scorecard`. A generator in a process of its own hides an effect, none,
two, or one that the library lacks in recordings of a rig whose every commissioning parameter is
redrawn; another step and integrator, another noise, a disturbance that no model has. The truth is
sealed; `ves-twin blind answer` sees the recordings alone (`tests/blind`). d: size in sigma of the
noise that commissioning errors cannot take away. Intervals are Wilson's, 95 %. Singles are drawn
evenly in log d from 6 to 40, so rates are not those of faults as they occur.
"""


def ves_twin(*words: str) -> str:
    command = [sys.executable, "-c", "from ves_twin.cli.main import main; raise SystemExit(main())"]
    done = subprocess.run([*command, *words], check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("--folder", type=Path, default=Path("runs/blind"))
    parser.add_argument("--suite", action="append", choices=list(SUITES), default=[])
    arguments = parser.parse_args()
    parts = [HEAD]
    for name in arguments.suite or list(SUITES):
        suite = str(arguments.folder / name)
        made = [*SUITES[name].split(), "--seed", str(SEED), "--out", suite]
        ves_twin("blind", "make", *made)
        ves_twin("blind", "answer", "--out", suite)
        parts.append(f"## {TITLES[name]}\n\n    ves-twin blind make {' '.join(made)}\n")
        parts.append(ves_twin("blind", "score", "--out", suite))
    arguments.page.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
