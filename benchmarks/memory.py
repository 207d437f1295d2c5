"""Peak memory of a short and of a long run: rows stream to disk, so it does not grow with length.

Run by `make bench`. Each run is a process of its own; the figure is what the operating system
counted for it.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile

RUN = """
import resource, sys
from pathlib import Path
import ves_twin as vt
changes = {"run.duration": float(sys.argv[2]), "run.log": sys.argv[3]}
vt.record(vt.Scenario.load("beam_horizontal_truth", changes), Path(sys.argv[1]))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def peak_memory(seconds: float, log: str) -> float:
    """Peak resident memory [MiB] of a run of so many simulated seconds."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", RUN, folder, str(seconds), log]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", type=float, default=600.0, help="length of the long run [s]")
    long = parser.parse_args().long
    print(f"logging     run of 20 s    run of {long:.0f} s   [MiB peak]")
    for log in ("admittance", "leg"):
        print(f"{log:<12}{peak_memory(20.0, log):11.0f}{peak_memory(long, log):15.0f}")


if __name__ == "__main__":
    main()
