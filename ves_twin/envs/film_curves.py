"""FilmCurves: curves beside a moving picture, bright up to the present time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.report.colours import MEASURED, REFERENCE
from ves_twin.report.figure import new_figure
from ves_twin.report.plots import Trace, draw_traces
from ves_twin.report.rerun.poses import GHOST_POSE, MACHINE_ARM, MACHINE_POSE, first_present

DOTS = 100
"""Pixels of the curves per inch of their figure."""

FADED = 0.3
"""Share of their colour that curves have after the present time."""

ROOM = 0.97
"""Share of the width that panels and their labels take."""

MARK = 96
"""Grey of the line at the present time."""

PLACES, TURNS = (0, 1, 2), (3, 4, 5)
AXES = ("x [mm]", "y [mm]", "z [mm]", "roll [deg]", "pitch [deg]", "yaw [deg]")
SCALES = (1e3, 1e3, 1e3, *(np.degrees(1.0),) * 3)


@dataclass(frozen=True)
class FilmCurves:
    """Curves of a whole recording as pixels, and where a time lies among them.

    Attributes:
        bright: the curves (height, width, 3).
        inside: pixel rows that lie in a panel (height,).
        start: time of the first pixel of the panels [s], and `left`, its column.
        left: see `start`.
        pace: columns a second [1/s].
    """

    bright: NDArray[np.uint8]
    inside: BoolArray
    start: float
    left: float
    pace: float

    @staticmethod
    def of(recording: Recording, width: int, height: int) -> FilmCurves:
        """The shift, the turn and the joint angle that move most, beside zero gravity.

        Args:
            recording: with two rows or more.
            width: of the pixels.
            height: of the pixels.
        """
        figure = new_figure(height / DOTS, width / DOTS)
        figure.set_dpi(DOTS)
        canvas: Any = FigureCanvasAgg(figure)
        drawn = _drawn(recording)
        panels = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (label, traces) in zip(panels, drawn, strict=True):
            draw_traces(axes, recording.time, traces, label)
        panels[-1].set_xlabel("time [s]", fontsize=8)
        figure.set_layout_engine("constrained", rect=(0.0, 0.0, ROOM, 1.0))
        canvas.draw()
        bright = np.asarray(canvas.buffer_rgba())[..., :3].copy()
        begin, end = recording.time[0], recording.time[-1]
        ends = panels[-1].transData.transform([[begin, 0.0], [end, 0.0]])[:, 0]
        pace = float(ends[1] - ends[0]) / max(float(end - begin), 1e-9)
        inside = np.zeros(height, bool)
        for axes in panels:
            box = axes.get_window_extent()
            inside[round(height - box.y1) : round(height - box.y0)] = True
        return FilmCurves(bright, inside, float(begin), float(ends[0]), pace)

    def at(self, time: float) -> NDArray[np.uint8]:
        """Pixels (height, width, 3): what comes after a time [s] is faded, a line marks it."""
        here = round(self.left + self.pace * (time - self.start))
        picture = self.bright.copy()
        panels = picture[self.inside]
        panels[:, here:] = 255.0 - FADED * (255.0 - panels[:, here:])
        panels[:, here : here + 2] = MARK
        picture[self.inside] = panels
        return picture


def _drawn(recording: Recording) -> list[tuple[str, list[Trace]]]:
    """Label and lines of each panel."""
    pose = first_present(recording, MACHINE_POSE, 6)
    reference = first_present(recording, GHOST_POSE, 6)
    held_against = any(name in recording.signals for name in GHOST_POSE)
    panels = []
    for axes in (PLACES, TURNS):
        k = _most(pose, axes)
        traces = [Trace("rig", SCALES[k] * pose[:, k], MEASURED)]
        if held_against:
            traces.append(Trace("true zero gravity", SCALES[k] * reference[:, k], REFERENCE))
        panels.append((AXES[k], traces))
    joints = first_present(recording, MACHINE_ARM, 3)
    k = _most(joints, (0, 1, 2))
    line = Trace(f"joint {k + 1}", np.degrees(joints[:, k]), MEASURED)
    return [*panels, (f"joint {k + 1} [deg]", [line])]


def _most(values: FloatArray, columns: tuple[int, ...]) -> int:
    """The column that moves most; the first where none does."""
    finite = np.nan_to_num(values[:, list(columns)])
    return columns[int(np.argmax(np.ptp(finite, axis=0)))]
