"""How often `compare` calls a column of a rig in order beyond noise: same plant, other noise.

    python benchmarks/compare_false_alarms.py --cases 100 --seconds 20

A recording is counted where any of its 25 columns is. Runs are of `identify_slow` in `fast`, each
with a seed of its own; nothing differs from the plant but noise and counts.
"""

from __future__ import annotations

import argparse
from collections import Counter

from scipy.stats import binomtest

import ves_twin as vt
from ves_twin.machines.compare import compare
from ves_twin.machines.machine import Named

PLANT = "ves2_pressure_fast"


def share(hits: int, of: int) -> str:
    ends = binomtest(hits, of).proportion_ci(0.95, "wilson")
    return f"{hits} of {of} ({hits / of:.1%}; {ends.low:.1%} to {ends.high:.1%})"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=20.0)
    options = parser.parse_args()
    scenario = vt.Scenario.load(
        "identify_slow", {"plant": PLANT, "run.duration": options.seconds, "run.settle": 1.0}
    )
    columns, recordings = 0, 0
    loud: Counter[str] = Counter()
    for seed in range(options.cases):
        recording = vt.simulate(scenario, seed=1000 + seed)
        found = compare([Named(f"seed {seed}", recording)]).recordings[0]
        columns += len(found.channels)
        recordings += bool(found.beyond_noise)
        loud.update(channel.name for channel in found.beyond_noise)
        print(f"{seed + 1} of {options.cases}: {recordings}", flush=True)
    print(f"recordings {share(recordings, options.cases)}")
    print(f"columns    {share(sum(loud.values()), columns)}: {dict(loud)}")


if __name__ == "__main__":
    main()
