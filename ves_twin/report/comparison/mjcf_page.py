"""rig_comparison_page: what compare found on a rig, as one HTML page and as lines of text."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.core.quantity import quantity
from ves_twin.machines.mjcf.compare_mjcf import FORGET, ColumnGap, RigComparison
from ves_twin.machines.mjcf.description import Mode
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html, paragraph, section, table
from ves_twin.report.page import html_page
from ves_twin.report.plots import MEASURED, RESIDUAL, SIMULATED, Trace, draw_traces

WORDS = {
    Mode.MOTION: "joints moved as recorded (inverse dynamics)",
    Mode.CONTROL: "commands fed in as recorded (open loop)",
    Mode.REFERENCE: "set-points fed into the controllers (closed loop)",
}

DRAWN = 6
"""Columns drawn for each recording and mode."""


def rig_comparison_page(found: Sequence[RigComparison]) -> str:
    """The page: for each recording and mode a table, then the columns."""
    parts = []
    for k, one in enumerate(found):
        rows = [
            (
                c.channel.name,
                quantity(c.rms, c.channel.unit),
                quantity(c.rms_slow, c.channel.unit),
                quantity(c.peak, c.channel.unit),
                quantity(c.mean, c.channel.unit),
                quantity(c.channel.sd, c.channel.unit),
            )
            for c in one.columns
        ]
        slow = f"rms below {0.5 * one.rate:g} Hz"
        head = ("column", "rms", slow, "peak", "mean", "noise of a row, declared")
        figures = [_figure(c, f"r{k}-{n}", one.poses) for n, c in enumerate(one.columns[:DRAWN])]
        parts.append(
            section(f"{one.name}: {WORDS[one.mode]}", table(head, rows, "difference"), *figures)
        )
    first = found[0]
    said = f"Rig {first.rig} ({first.identity}), made by ves-twin compare."
    if any(one.mode is not Mode.MOTION for one in found):
        said += f" What is simulated forwards is compared from {FORGET:g} s on."
    lead = paragraph(said, "note")
    return html_page("Measured against simulated", [lead, *parts])


def comparison_lines(found: Sequence[RigComparison]) -> list[str]:
    """The same as text."""
    lines = []
    for one in found:
        lines.append(f"{one.name}: rig {one.rig}, {WORDS[one.mode]}")
        lines.append(
            f"  {'column':<20}{'rms':>12}{'below ' + f'{0.5 * one.rate:g} Hz':>16}{'peak':>12}"
        )
        lines += [
            f"  {c.channel.name:<20}{quantity(c.rms, c.channel.unit):>12}"
            f"{quantity(c.rms_slow, c.channel.unit):>16}{quantity(c.peak, c.channel.unit):>12}"
            for c in one.columns
        ]
    return lines


def _figure(column: ColumnGap, name: str, poses: bool) -> Html:
    figure = new_figure(3.4)
    above, below = figure.subplots(2, 1, sharex=True)
    lines = [
        Trace("measured", column.measured, MEASURED),
        Trace("simulated", column.simulated, SIMULATED),
    ]
    unit = column.channel.unit.replace("*", " ")
    draw_traces(above, column.time, lines, unit)
    gap = [Trace("difference", column.measured - column.simulated, RESIDUAL)]
    draw_traces(below, column.time, gap, f"difference, {unit}", 2.0 * column.channel.sd)
    below.set_xlabel("number of the pose" if poses else "time, s", fontsize=8)
    return svg(figure, name, f"{column.channel.name}. Grey: two sigma of a row's noise.")
