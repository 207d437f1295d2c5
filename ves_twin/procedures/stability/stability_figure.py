"""draw_map: the picture of a stability map."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ves_twin.procedures.stability.map_point import MapPoint
from ves_twin.report.picture import save_picture

_COLOURS = {"none": "#4c566a", "error": "#c2462e", "feedback": "#2f6fb0"}


def draw_map(points: Sequence[MapPoint], plant: str, path: Path) -> None:
    """Lowest stable mass over payload against leg gain, and the frequency at the limit.

    Args:
        points: of the map.
        plant: name of the plant, for the title.
        path: PNG that is written.
    """
    figure = Figure(figsize=(8.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    limits, frequencies = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    limits.axhspan(0.45, 0.65, color="#c2462e", alpha=0.10, lw=0)
    limits.axhline(0.5, color="#c2462e", lw=0.8, ls=":")
    limits.text(0.01, 0.5, " thesis 5.4: half the payload", transform=limits.get_yaxis_transform(),
                fontsize=8, va="bottom")  # fmt: skip
    for place in dict.fromkeys(p.place for p in points):
        colour = _COLOURS[place]
        row = [p for p in points if p.place == place]
        gains = [p.gain for p in row]
        limits.plot(gains, [p.share for p in row], "-", color=colour, label=f"{place}: full plant")
        limits.plot(gains, [p.one_axis / p.payload for p in row], "--", color=colour, lw=1.0,
                    label=f"{place}: one axis")  # fmt: skip
        for p in row:
            limits.plot(p.gain, p.share, "o", color=colour, ms=5, fillstyle=_fill(p.bounded))
            for run in p.runs:
                grows = run.verdict == "growing"
                limits.plot(p.gain, run.mass / p.payload, "x" if grows else "+", color=colour, ms=8)
        bounded = [p for p in row if p.bounded]
        frequencies.plot([p.gain for p in bounded], [p.frequency for p in bounded], "o-",
                         color=colour, ms=4)  # fmt: skip
    limits.set_ylabel("lowest stable mass / payload")
    limits.set_ylim(bottom=0.0)
    limits.set_title(
        f"Stability of the admittance loop, {plant}\n"
        "hollow: end of the range tried; x run grew, + run decayed", fontsize=10
    )  # fmt: skip
    limits.legend(fontsize=8, ncols=2)
    frequencies.axhspan(10.0, 13.2, color="0.85", lw=0)
    frequencies.set_ylabel("frequency at the limit [Hz]")
    frequencies.set_xlabel("leg gain [1/s]")
    for axes in (limits, frequencies):
        axes.grid(alpha=0.3)
    save_picture(figure, path, 120)


def _fill(bounded: bool) -> str:
    return "full" if bounded else "none"
