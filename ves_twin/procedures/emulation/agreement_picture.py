"""write_agreement: both gravity methods on the same motion, as in figs 3-7 and 3-8."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.report.picture import save_picture


def write_agreement(learned: Recording, model: Recording, path: Path) -> None:
    """Dynamic moment about X of the sensor (mean of 5 rows), and rotation about X, by both methods.

    Args:
        learned: last full-speed run of the Learning Method.
        model: run of the Model Method.
        path: PNG to write.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    reference = learned["reference.pose"][:, 3] * 1e3
    right.plot(learned.time, reference, "k--", lw=0.9, label="zero-g reference")
    for name, run, style in (("Learning", learned, "C0-"), ("Model", model, "C1-")):
        dynamic = run["sensor.wrench"][:, 3] - run["gravity.estimate"][:, 3]
        smooth = np.convolve(dynamic, np.ones(5) / 5.0, mode="same")
        left.plot(run.time, smooth, style, lw=0.8, label=f"{name} Method")
        right.plot(run.time, run["truth.pose"][:, 3] * 1e3, style, lw=0.9, label=f"{name} Method")
    left.set_ylabel("dynamic moment about X [N m]")
    right.set_ylabel("rotation about X [mrad]")
    for axes in (left, right):
        axes.set_xlabel("time [s]")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    save_picture(figure, path, 100)
