"""Figures of a diagnosis: levels before and after, maps of what is left, traces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.diagnosis.bank.envelope import ENVELOPE_SD
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.record.adequacy import EnergyCell
from ves_twin.diagnosis.verdict.report_traces import ReportTraces, Traces
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.report.colours import AFTER, BEFORE, MEASURED, RESIDUAL, TOLERANCES
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html
from ves_twin.report.plots import Band, Trace, draw_cells, draw_change, draw_traces

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSIDE = 0.95
"""Share of the rows within the envelope from which a measurement counts as inside it: the share
that a machine in order has there."""

ALONE = "best without a cause, within tolerances"
"""What the model is called that has its tolerances fitted and nothing else."""


def change_figure(verdict: Verdict) -> Html:
    """Residual of every channel before and after, in sigma."""
    errors = verdict.residuals
    before = [error.before for error in errors.values()]
    after = [error.after for error in errors.values()]
    figure = draw_change(list(errors), before, after, "rms error, in sigma of the noise", 1.0)
    caption = "Error of each channel, with the model before and after. Red: noise alone."
    return svg(figure, "change", caption)


def cells_figure(exhibit: ReportTraces, cells: Sequence[EnergyCell], kind: str, name: str) -> Html:
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


def _ends(cell: EnergyCell) -> str:
    return f"{cell.low:.2g}" if cell.high - cell.low < 1e-9 else f"{cell.low:.2g}-{cell.high:.2g}"


def answer_figure(exhibit: ReportTraces, fitted: str) -> Html:
    """`draw_answer` as a part of a page."""
    traces, column = _telling(exhibit)
    off = np.abs(traces.measured[:, column] - traces.nominal[:, column])
    inside = np.nanmean(off <= ENVELOPE_SD * traces.reach[:, column]) >= INSIDE
    meaning = "point by point: a curve inside may still be one that no such machine draws."
    if inside and exhibit.causes:
        meaning = (
            "point by point. The measurement stays inside: a look at this channel does not show"
            f" the cause, the course of all {len(exhibit.channels)} together does."
            if len(exhibit.channels) > 1
            else "point by point. The measurement stays inside: not its size shows the cause, its"
            " course in time does."
        )
    caption = (
        f"{exhibit.channels[column].name} of {traces.name}, the channel that tells most; below, the"
        " same less the model before. Grey: where a machine in order may lie, by noise and"
        f" tolerances (95 % of the rows), {meaning}"
    )
    return svg(draw_answer(exhibit, fitted), "answer", caption)


def _telling(exhibit: ReportTraces) -> tuple[Traces, int]:
    """Recording and channel that tell most."""
    column = int(exhibit.telling[0])
    return max(exhibit.traces, key=lambda t: np.nansum(np.square(t.before[:, column]))), column


def draw_answer(exhibit: ReportTraces, fitted: str) -> Figure:
    """The channel that tells most: measured, model before and after, and where it may lie in order.

    Below the same less the model before, since a fault is often too small to see beside a motion.

    Args:
        exhibit: traces of a verdict.
        fitted: what the model after is called, for instance "with the cause".
    """
    traces, column = _telling(exhibit)
    channel = exhibit.channels[column]
    figure = new_figure(3.8)
    above, below = figure.subplots(2, 1, sharex=True)
    nominal = traces.nominal[:, column].astype(float)
    lines = [
        Trace("measured", traces.measured[:, column].astype(float), MEASURED),
        Trace("model before", nominal, BEFORE),
        Trace(f"model {fitted}", traces.fitted[:, column].astype(float), AFTER),
    ]
    reach = ENVELOPE_SD * traces.reach[:, column].astype(float)
    unit = channel.unit.replace("*", " ")
    band = Band("machine in order", nominal - reach, nominal + reach)
    draw_traces(above, traces.time, lines, f"{channel.name}, {unit}", band)
    gaps = [Trace(one.label, one.values - nominal, one.colour) for one in lines]
    draw_traces(below, traces.time, gaps, f"less model before, {unit}", Band("", -reach, reach))
    below.get_legend().remove()
    below.set_xlabel("t, s", fontsize=8)
    return figure


def trace_figure(
    exhibit: ReportTraces, traces: Traces, column: int, fitted: str, name: str
) -> Html:
    """One channel: measured, and the model with tolerances alone and with the cause.

    Below: what each of the two leaves, in sigma.
    """
    channel = exhibit.channels[column]
    figure = new_figure(3.6)
    above, below = figure.subplots(2, 1, sharex=True)
    lines = [Trace("measured", traces.measured[:, column].astype(float), MEASURED)]
    left = [Trace("before", traces.before[:, column], BEFORE)]
    if exhibit.causes:
        alone = traces.tolerances[:, column].astype(float)
        lines.append(Trace(ALONE, alone, TOLERANCES))
        left = [Trace(ALONE, traces.without[:, column], TOLERANCES)]
    lines.append(Trace(fitted, traces.fitted[:, column].astype(float), AFTER))
    left.append(Trace(fitted, traces.after[:, column], AFTER))
    draw_traces(above, traces.time, lines, channel.unit.replace("*", " "))
    draw_traces(below, traces.sigma_time, left, "left over, sigma", 2.0)
    below.set_xlabel("t, s", fontsize=8)
    caption = (
        f"{channel.name}, {traces.name}. Below: measured less model. Grey: two sigma of noise."
    )
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
