"""Figures of a diagnosis: levels before and after, maps of what is left, traces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.diagnosis.adequacy import Cell
from ves_twin.diagnosis.forward import Channel
from ves_twin.diagnosis.report_traces import ReportTraces, Traces
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html
from ves_twin.report.plots import (
    MEASURED,
    RESIDUAL,
    SIMULATED,
    Trace,
    draw_cells,
    draw_change,
    draw_traces,
)

FITTED = "#1b7f5c"
"""Colour of the fitted model, apart from measured and nominal."""


def change_figure(verdict: Verdict) -> Html:
    """Residual of every channel before and after, in sigma."""
    errors = verdict.residuals
    before = [error.before for error in errors.values()]
    after = [error.after for error in errors.values()]
    figure = draw_change(list(errors), before, after, "rms / sigma", 1.0)
    caption = "Residual of each channel: nominal model, and the fitted one. Red: noise alone."
    return svg(figure, "change", caption)


def cells_figure(exhibit: ReportTraces, cells: Sequence[Cell], kind: str, name: str) -> Html:
    """Map of channels against bands ("band") or stretches ("time"), all recordings."""
    chosen = [cell for cell in cells if cell.kind == kind]
    several = len(exhibit.traces) > 1
    rows: dict[tuple[int, int], str] = {}
    for cell in chosen:
        prefix = f"{cell.recording + 1}: " if several else ""
        rows[cell.recording, cell.channel] = prefix + exhibit.channels[cell.channel].name
    columns = max((sum((c.recording, c.channel) == key for c in chosen) for key in rows), default=0)
    values = np.full((len(rows), columns), np.nan)
    labels = [""] * columns
    for i, key in enumerate(rows):
        own = [c for c in chosen if (c.recording, c.channel) == key]
        for j, cell in enumerate(own):
            values[i, j] = np.sqrt(cell.energy / cell.freedom)
            labels[j] = labels[j] or _ends(cell)
    axis = "frequency, Hz" if kind == "band" else "time, s"
    figure = draw_cells(list(rows.values()), labels, values, axis)
    return svg(figure, f"{name}-{kind}", f"Rms in sigma by {axis} (1 = noise).")


def _ends(cell: Cell) -> str:
    return f"{cell.low:.2g}" if cell.high - cell.low < 1e-9 else f"{cell.low:.2g}-{cell.high:.2g}"


def trace_figure(
    exhibit: ReportTraces, traces: Traces, column: int, fitted: str, name: str
) -> Html:
    """One channel: measured, nominal and fitted above, both residuals in sigma below."""
    channel = exhibit.channels[column]
    figure = new_figure(3.6)
    above, below = figure.subplots(2, 1, sharex=True)
    lines = [
        Trace("measured", traces.measured[:, column].astype(float), MEASURED),
        Trace("nominal", traces.nominal[:, column].astype(float), SIMULATED),
        Trace(fitted, traces.fitted[:, column].astype(float), FITTED),
    ]
    draw_traces(above, traces.time, lines, channel.unit.replace("*", " "))
    left = [
        Trace("before", traces.before[:, column], SIMULATED),
        Trace("after", traces.after[:, column], FITTED),
    ]
    draw_traces(below, traces.sigma_time, left, "residual, sigma", 2.0)
    below.set_xlabel("t, s", fontsize=8)
    caption = f"{channel.name}, {traces.name}. Grey: two sigma of noise."
    return svg(figure, f"{name}-{channel.name}", caption)


def residuals_figure(channels: Sequence[Channel], traces: Traces, name: str) -> Html:
    """What is left of many channels, in sigma, one above the other."""
    figure = new_figure(0.5 + 0.7 * len(channels))
    axes = np.atleast_1d(figure.subplots(len(channels), 1, sharex=True))
    for c, (one, channel) in enumerate(zip(axes, channels, strict=True)):
        line = Trace(channel.name, traces.after[:, c], RESIDUAL)
        draw_traces(one, traces.sigma_time, [line], channel.name, 2.0)
        one.yaxis.label.set(rotation=0, ha="right", va="center")
    axes[-1].set_xlabel("t, s", fontsize=8)
    return svg(figure, f"{name}-left", f"What is left in {traces.name}, sigma. Grey: two sigma.")
