"""draw_sweep: the table of a sweep as one picture: error of each axis over what was varied."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow.parquet as pq

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.signals import SIGNALS
from ves_twin.report.figure import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_LINES = 8
"""Lines of one plot; a table of more settings is drawn for the first of them."""

KINDS = {"error": "emulation error", "tracking": "tracking error"}
"""First word of a table's columns -> what they hold."""

_MILLI = 1e3


def draw_sweep(table: Path, keys: Mapping[str, str]) -> Figure:
    """Rms error of each axis over the first varied number, a line for each setting of the rest.

    Runs that ended early are crosses: their errors count up to their end only.

    Args:
        table: the Parquet table of a sweep.
        keys: varied key -> unit.

    Raises:
        InvalidInputError: no varied key holds numbers, or the table has no errors.
    """
    columns = pq.read_table(table).to_pydict()
    numbers = [key for key in keys if all(_number(v) for v in columns[key])]
    kind = next((name for name in KINDS if f"{name}.x.rms" in columns), "")
    if not numbers or not kind:
        came = "errors over " + (", ".join(numbers) or "words alone")
        raise InvalidInputError("--plot", came, "a varied number, and runs with a pose")
    x, rest = numbers[0], [key for key in keys if key != numbers[0]]
    settings = list(dict.fromkeys(zip(*(columns[key] for key in rest), strict=True))) or [()]
    figure = new_figure(5.4)
    plots = figure.subplots(2, 3, sharex=True)
    pose = SIGNALS["truth.pose"]
    for axes, axis, unit in zip(plots.flat, pose.axes, pose.units, strict=True):
        for values in settings[:MOST_LINES]:
            rows = [
                n
                for n in range(len(columns[x]))
                if tuple(columns[key][n] for key in rest) == values
            ]
            label = ", ".join(f"{key} {value}" for key, value in zip(rest, values, strict=True))
            _draw_line(axes, columns, rows, (x, f"{kind}.{axis}.rms"), label)
        axes.set_title(f"{axis}, {'mrad' if unit == 'rad' else 'mm'}", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(color="#e8ebee", linewidth=0.6)
        axes.set_ylim(bottom=0.0)
    unit = keys[x]
    for axes in plots[1]:
        axes.set_xlabel(f"{x} [{unit}]" if unit else x, fontsize=9)
    figure.suptitle(f"rms {KINDS[kind]}; crosses: runs that ended early", fontsize=10)
    if rest:
        lines, labels = plots.flat[0].get_legend_handles_labels()
        figure.legend(lines, labels, fontsize=8, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _draw_line(
    axes: Axes,
    columns: Mapping[str, list[Any]],
    rows: list[int],
    names: tuple[str, str],
    label: str,
) -> None:
    known = sorted(
        (n for n in rows if columns[names[1]][n] is not None), key=columns[names[0]].__getitem__
    )
    x = np.array([columns[names[0]][n] for n in known], float)
    y = _MILLI * np.array([columns[names[1]][n] for n in known], float)
    whole = np.array([columns["outcome"][n] == "completed" for n in known], bool)
    (line,) = axes.plot(x[whole], y[whole], "o-", markersize=4, linewidth=1.2, label=label)
    axes.plot(x[~whole], y[~whole], "x", color=line.get_color())


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
