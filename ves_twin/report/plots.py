"""draw_traces, draw_levels, draw_cells: the plots that reports share, on axes or figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.report.colours import AFTER, BEFORE, ENVELOPE, LIMIT
from ves_twin.report.figure import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

POINTS = 700
"""Stretches of a long line, each drawn from its least to its largest value."""

LEAST = 0.03
"""Bars begin at this share of the mark; what is smaller has none."""


@dataclass(frozen=True)
class Trace:
    """One line of a plot: label, values (n,), colour."""

    label: str
    values: FloatArray
    colour: str


@dataclass(frozen=True)
class Band:
    """The stretch between two lines: label, lower and upper line (n,)."""

    label: str
    low: FloatArray
    high: FloatArray


def thinned(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A line of at most 2 POINTS points that shows every peak of a longer one."""
    if len(time) <= 2 * POINTS:
        return time, values
    per = int(np.ceil(len(time) / POINTS))
    count = len(time) // per
    rows = values[: count * per].reshape(count, per)
    filled = np.where(np.isfinite(rows), rows, 0.0)
    ends = np.sort(np.stack([filled.argmin(axis=1), filled.argmax(axis=1)], axis=1), axis=1)
    at = (np.arange(count)[:, None] * per + ends).ravel()
    return time[at], values[at]


def draw_traces(
    axes: Axes,
    time: FloatArray,
    traces: Sequence[Trace],
    label: str,
    band: float | Band | None = None,
) -> None:
    """Lines over time.

    Args:
        axes: drawn upon.
        time: [s] (n,).
        traces: what is drawn.
        label: of the vertical axis, with its unit.
        band: grey band behind them; its half-width where it lies about zero.
    """
    if isinstance(band, Band):
        x, low = thinned(time, band.low)
        _, high = thinned(time, band.high)
        axes.fill_between(x, low, high, color=ENVELOPE, linewidth=0, label=band.label)
    elif band is not None and np.isfinite(band):
        axes.axhspan(-band, band, color=ENVELOPE, linewidth=0)
    for k, trace in enumerate(traces):
        x, y = thinned(time, trace.values)
        behind = k == 0 and len(traces) > 1  # the first shows behind the others
        wide, opacity = (3.6, 0.45) if behind else (1.2, 1.0)
        axes.plot(x, y, color=trace.colour, linewidth=wide, alpha=opacity, label=trace.label)
    axes.set_ylabel(label, fontsize=8)
    axes.tick_params(labelsize=8)
    axes.grid(color="#e8ebee", linewidth=0.6)
    axes.margins(x=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if len(traces) > 1 or isinstance(band, Band):
        axes.legend(
            fontsize=7,
            loc="lower right",
            bbox_to_anchor=(1.0, 0.98),
            ncols=len(traces) + 1,
            frameon=False,
        )


def draw_levels(names: Sequence[str], levels: Sequence[float], unit: str, mark: float) -> Figure:
    """Horizontal bars on a logarithmic axis.

    Args:
        names: of the bars, from the top.
        levels: their lengths, positive.
        unit: label of the axis.
        mark: a line across, for instance 1 sigma.
    """
    figure = new_figure(0.8 + 0.2 * len(names))
    axes = figure.add_subplot()
    low = LEAST * mark
    values = np.maximum(np.nan_to_num(np.array(levels, float)), low)
    place = np.arange(len(names))
    axes.barh(place, values - low, left=low, color=BEFORE, height=0.65)
    _plain_log(axes)
    axes.set_xlim(low, max(3.0 * mark, 1.5 * values.max(initial=1.0)))
    axes.axvline(mark, color=LIMIT, linewidth=1.0)
    axes.set_yticks(place, list(names), fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel(unit, fontsize=8)
    axes.tick_params(axis="x", labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure


def _plain_log(axes: Axes) -> None:
    """A logarithmic axis with plain numbers at 1, 2 and 5 of each decade."""
    from matplotlib.ticker import LogLocator, NullFormatter  # slow to import

    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


def draw_change(
    names: Sequence[str], before: Sequence[float], after: Sequence[float], unit: str, mark: float
) -> Figure:
    """Where each of many levels was and where it is now, on a logarithmic axis.

    Args:
        names: of the lines, from the top.
        before: levels there were, positive.
        after: levels there are now.
        unit: label of the axis.
        mark: a line across, for instance 1 sigma.
    """
    figure = new_figure(0.9 + 0.2 * len(names))
    axes = figure.add_subplot()
    there, here = np.maximum(before, LEAST * mark), np.maximum(after, LEAST * mark)
    place = np.arange(len(names))
    axes.hlines(place, there, here, color="#c3cad1", linewidth=2.0)
    axes.plot(there, place, "o", color=BEFORE, markersize=6, label="before")
    axes.plot(here, place, "o", color=AFTER, markersize=6, label="after")
    _plain_log(axes)
    both = np.concatenate([there, here, [mark]])
    axes.set_xlim(both.min() / 1.5, both.max() * 1.5)
    axes.axvline(mark, color=LIMIT, linewidth=1.0)
    axes.set_yticks(place, list(names), fontsize=8)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlabel(unit, fontsize=8)
    axes.tick_params(axis="x", labelsize=8)
    axes.grid(axis="y", color="#eef0f2", linewidth=0.6)
    figure.legend(fontsize=8, loc="outside upper right", ncols=2, frameon=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure


def draw_cells(
    rows: Sequence[str], columns: Sequence[str], values: FloatArray, unit: str
) -> Figure:
    """A map of cells on a logarithmic colour scale, each with its number.

    Args:
        rows: names of the rows.
        columns: names of the columns.
        values: (rows, columns), positive; NaN is left white.
        unit: what the numbers are.
    """
    from matplotlib.colors import LogNorm

    figure = new_figure(1.1 + 0.21 * len(rows))
    axes = figure.add_subplot()
    top = max(10.0, float(np.nanmax(values, initial=1.0)))
    shown = np.clip(values, 1.0, None)
    axes.pcolormesh(shown, cmap="YlOrRd", norm=LogNorm(1.0, top), edgecolors="white", linewidth=1)
    for i, j in np.ndindex(*values.shape):
        if np.isfinite(values[i, j]):
            dark = shown[i, j] > top**0.6
            axes.text(
                j + 0.5,
                i + 0.5,
                f"{values[i, j]:.2g}" if values[i, j] < 99.5 else f"{values[i, j]:.0f}",
                ha="center",
                va="center",
                fontsize=7,
                color="white" if dark else "#333333",
            )
    axes.set_xticks(np.arange(len(columns)) + 0.5, list(columns), fontsize=7)
    axes.set_yticks(np.arange(len(rows)) + 0.5, list(rows), fontsize=8)
    axes.tick_params(length=0)
    axes.invert_yaxis()
    axes.set_xlabel(unit, fontsize=8)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return figure
