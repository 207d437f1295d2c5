"""The picture of docs/sweeps.md from the table of its sweep: peak error over gain, by age.

`python benchmarks/sweep_picture.py runs/beam_horizontal_truth-sweep/sweep.parquet docs/sweep.png`
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pyarrow.parquet as pq

mpl.use("agg")
import matplotlib.pyplot as plt

GAIN, AGE, ERROR = "legs.gain", "gravity.age", "error.y.peak"


def main(table: Path, target: Path) -> None:
    columns = pq.read_table(table).to_pydict()
    gain, age, error = (np.array(columns[name]) for name in (GAIN, AGE, ERROR))
    whole = np.array(columns["outcome"]) == "completed"
    ages = sorted(set(age))
    figure, axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    shades = plt.colormaps["viridis"](np.linspace(0.0, 0.85, len(ages)))
    for value, shade in zip(ages, shades, strict=True):
        rows = whole & (age == value)
        order = np.argsort(gain[rows])
        axes.plot(gain[rows][order], 1e3 * error[rows][order], "o-", color=shade, label=f"{value}")
    for value in sorted(set(gain[~whole])):
        outcomes = sorted({o for o, g in zip(columns["outcome"], gain, strict=True) if g == value})
        axes.axvline(value, color="0.6", linestyle=":")
        axes.text(value, 1.0, f"{', '.join(outcomes)} ", rotation=90, va="bottom", ha="right")
    axes.set(xlabel="leg gain [1/s]", ylabel="peak error in Y [mm]", ylim=(0.0, None))
    axes.legend(title="age of the gravity\nestimate [cycles]", loc="lower left", ncols=2)
    axes.grid(alpha=0.3)
    figure.savefig(target, dpi=130)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
