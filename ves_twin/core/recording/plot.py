"""plot: signals of a recording against time, one panel each, as a matplotlib figure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ves_twin.core.errors import InvalidInputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ves_twin.core.recording.recording import Recording

PANEL = (8.0, 1.8)
"""Width and height of a panel [inch]: a notebook's page."""

MOST = 12
"""Panels that can be read at once."""


def plot(recording: Recording, names: Iterable[str]) -> Figure:
    """Draw signals; columns of one signal that share a unit share a panel.

    Args:
        recording: whose rows are drawn.
        names: signals, by the names of `recording.signals`.

    Returns:
        The figure; a notebook shows it, `figure.savefig(path)` keeps it.

    Raises:
        UnknownNameError: a signal that is not in the recording.
        InvalidInputError: no signal, or more panels than can be read.
    """
    from matplotlib.figure import Figure  # slow to import

    panels = [(name, unit) for name in names for unit in _units(recording, name)]
    if not 0 < len(panels) <= MOST:
        raise InvalidInputError("signals to draw", f"{len(panels)} panels", f"1 to {MOST}")
    width, height = PANEL
    figure = Figure(figsize=(width, height * len(panels) + 0.4), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (name, unit) in zip(axes, panels, strict=True):
        signal = recording.info.signal(name)
        for i, label in enumerate(signal.axes):
            if signal.units[i] == unit:
                axis.plot(recording.time, recording[name][:, i], linewidth=0.9, label=label or name)
        axis.set_ylabel(f"{name} [{unit}]", fontsize="small")
        axis.grid(alpha=0.3)
        if signal.width > 1:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="x-small")
    axes[-1].set_xlabel("time [s]")
    return figure


def _units(recording: Recording, name: str) -> tuple[str, ...]:
    """Units of a signal's columns, each once; says the nearest name where there is no such."""
    recording[name]
    return tuple(dict.fromkeys(recording.info.signal(name).units))
