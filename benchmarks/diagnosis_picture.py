"""The README's second picture: a hidden fault, what it does to residuals, and how it is named.

Run by `make picture`, after the runs that it draws: the folders of a recording with one hidden
effect and of its diagnosis.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

import ves_twin as vt

mpl.use("agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes


def residuals(axes: Axes, verdict: dict) -> None:
    """Rms residual of every channel, in noise sd, by the plant as it is and as extended."""
    names = list(verdict["residuals"])
    rows = np.arange(len(names))
    for key, colour, label in (
        ("before", "C3", "nominal plant"),
        ("after", "C0", "with the cause, commissioning errors fitted"),
    ):
        values = [verdict["residuals"][name][key] for name in names]
        axes.scatter(values, rows, s=26, color=colour, label=label, zorder=3)
    axes.axvline(1.0, color="0.5", lw=1.0)
    axes.set_xscale("log")
    axes.set_yticks(rows, names, fontsize=8)
    axes.invert_yaxis()
    axes.grid(alpha=0.3)
    axes.set_xlabel("rms residual [noise sd]")
    axes.legend(loc="lower right", fontsize=8)


def rivals(axes: Axes, verdict: dict) -> None:
    """How much more each rival leaves, of those that were fitted with the full simulation."""
    fitted = [r for r in verdict["rivals"] if r["behind"] is not None]
    fitted = sorted(fitted, key=lambda r: r["behind"])[:6]
    behind = [max(r["behind"], 1.0) for r in fitted]
    axes.barh(range(len(fitted)), behind, color=["C0"] + ["0.7"] * (len(fitted) - 1))
    axes.set_yticks(range(len(fitted)), [" + ".join(r["causes"]) for r in fitted], fontsize=8)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlabel("chi^2 left more than by the best")
    axes.grid(alpha=0.3, axis="x")


def main(recording: Path, diagnosis: Path, path: Path) -> None:
    """Draw the picture into a file."""
    verdict = json.loads((diagnosis / "verdict.json").read_text(encoding="utf-8"))
    (cause,) = verdict["causes"]
    ((name, size),) = cause["parameters"].items()
    hidden = ", ".join(f"{key} = {value:g}" for key, value in effects(recording).items())
    figure = plt.figure(figsize=(12.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.0))
    residuals(left, verdict)
    rivals(right, verdict)
    found = f"{size['value']:.4g} ({size['low']:.4g} to {size['high']:.4g}) {size['unit']}"
    figure.suptitle(
        f"hidden: {hidden}      found: {cause['effect']} at {cause['target']}, "
        f"{name.split(':')[-1]} {found}",
        fontsize=10,
    )
    figure.savefig(path, dpi=110)


def effects(recording: Path) -> dict[str, float]:
    """What was hidden in a run, by the settings that it keeps."""
    found: dict[str, float] = {}

    def walk(prefix: str, content: object) -> None:
        if isinstance(content, dict):
            for key, value in content.items():
                walk(f"{prefix}.{key}" if prefix else key, value)
        elif isinstance(content, int | float):
            found[prefix] = float(content)

    run = vt.load_recording(recording / "recording.parquet")
    walk("", json.loads(run.info.settings)["effects"])
    return found


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:4]))
