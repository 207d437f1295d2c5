"""Figures of a comparison: levels, bands, stretches of time, and traces."""

from __future__ import annotations

import numpy as np

from ves_twin.diagnosis.bank.envelope import ENVELOPE_SD
from ves_twin.diagnosis.record.residuals.cells import Cell
from ves_twin.diagnosis.record.residuals.channel import ChannelComparison
from ves_twin.machines.comparison import RecordingComparison
from ves_twin.report.colours import BEFORE, MEASURED, REFERENCE, RESIDUAL
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html
from ves_twin.report.plots import Band, Trace, draw_cells, draw_levels, draw_traces

SIMULATED = "simulated"
"""What the expected line is called where it is a model's."""

OTHER = "other recording"
"""The same where it is another recording."""

IN_ORDER = "where a machine in order may lie, by its noise and tolerances (95 % of the rows)"
"""What a tolerance envelope is."""


def levels_figure(recording: RecordingComparison, name: str) -> Html:
    """Rms of every column in sigma."""
    labels = [
        f"{c.name} ({c.axis})" if c.axis not in c.name else c.name for c in recording.channels
    ]
    figure = draw_levels(labels, [c.rms_sigma for c in recording.channels], "rms / sigma", 1.0)
    return svg(figure, f"{name}-levels", "Residual of each column; red: its noise.")


def cells_of(channel: ChannelComparison, kind: str) -> tuple[Cell, ...]:
    """Bands ("band") or stretches ("time")."""
    return channel.bands if kind == "band" else channel.blocks


def cells_figure(recording: RecordingComparison, kind: str, name: str) -> Html:
    """Map of columns against bands ("band") or stretches ("time")."""
    cells = [cells_of(c, kind) for c in recording.channels]
    columns = list(dict.fromkeys(cell.label for row in cells for cell in row))
    values = np.full((len(cells), len(columns)), np.nan)
    for i, row in enumerate(cells):
        for cell in row:
            values[i, columns.index(cell.label)] = cell.sigma
    axis = "frequency" if kind == "band" else "time"
    figure = draw_cells([c.name for c in recording.channels], columns, values, axis)
    caption = f"Residual over its noise by {axis}, in sigma (1 = noise)."
    return svg(figure, f"{name}-{kind}", caption)


def channel_figure(
    channel: ChannelComparison, recording: RecordingComparison, other: str, name: str
) -> Html:
    """One column: measured and expected above, their difference below."""
    traces = recording.traces
    measured = traces.measured[channel.signal][:, channel.column]
    expected = traces.expected[channel.signal][:, channel.column]
    figure = new_figure(3.4)
    above, below = figure.subplots(2, 1, sharex=True)
    colour = BEFORE if other == SIMULATED else REFERENCE
    lines = [Trace("measured", measured, MEASURED), Trace(other, expected, colour)]
    unit = channel.unit.replace("*", " ")
    sd = traces.reach.get(channel.name)
    residual = [Trace("residual", measured - expected, RESIDUAL)]
    if sd is None:
        draw_traces(above, traces.time, lines, unit)
        draw_traces(below, traces.time, residual, f"residual, {unit}", 2.0 * channel.sigma)
    else:
        reach = ENVELOPE_SD * sd
        band = Band("machine in order", expected - reach, expected + reach)
        draw_traces(above, traces.time, lines, unit, band)
        draw_traces(below, traces.time, residual, f"residual, {unit}", Band("", -reach, reach))
        below.get_legend().remove()
    below.set_xlabel(_clock(recording), fontsize=8)
    grey = "two sigma of noise" if sd is None else IN_ORDER
    caption = f"{channel.name} ({channel.axis}). Grey: {grey}."
    return svg(figure, f"{name}-{channel.name}", caption)


def residuals_figure(recording: RecordingComparison, name: str) -> Html:
    """Residuals of many columns, in sigma, one above the other."""
    channels, traces = recording.channels, recording.traces
    figure = new_figure(0.5 + 0.75 * len(channels))
    axes = np.atleast_1d(figure.subplots(len(channels), 1, sharex=True))
    for one, channel in zip(axes, channels, strict=True):
        gap = traces.measured[channel.signal] - traces.expected[channel.signal]
        line = Trace(channel.name, gap[:, channel.column] / (channel.sigma or 1.0), RESIDUAL)
        draw_traces(one, traces.time, [line], channel.name, 2.0)
        one.yaxis.label.set(rotation=0, ha="right", va="center")
    axes[-1].set_xlabel(_clock(recording), fontsize=8)
    return svg(figure, f"{name}-residuals", "Residuals in sigma. Grey: two sigma.")


def _clock(recording: RecordingComparison) -> str:
    return "number of the pose" if recording.poses else "t, s"
