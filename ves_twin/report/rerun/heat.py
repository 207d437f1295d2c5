"""send_heat: errors in sigma as a map of channels over time, with a line at the present time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.verdict.report_traces import Traces

STRETCHES, HEIGHT, LINE = 240, 60, 6
"""Stretches of time across the map, its pixels from top to bottom, and those of a channel's line at
least."""

LABEL = 20.0
"""Where the names of the channels stand [pixel from the left]."""

HOTTEST = 100.0
"""Rms in sigma from which all is equally hot; 1 is noise and the coldest."""


def send_heat(
    stream: rr.RecordingStream, root: str, channels: Sequence[Channel], traces: Traces
) -> None:
    """Send ROOT/before and ROOT/after: the map, names of the channels, and the cursor.

    Args:
        stream: where it goes.
        root: entity of the recording's heat.
        channels: a line of the map each, from the top.
        traces: one recording.
    """
    time = traces.sigma_time
    count = min(STRETCHES, len(time))
    ends = np.linspace(0, len(time), count + 1).astype(int)
    wide = max(1, STRETCHES // count)
    names = [channel.name for channel in channels]
    line = max(LINE, HEIGHT // len(names))
    places = [(LABEL, line * (n + 0.4)) for n in range(len(names))]
    bottom = float(line * len(names))
    moments = 0.5 * (time[ends[:-1]] + time[ends[1:] - 1])
    for name, sigma in (("before", traces.before), ("after", traces.after)):
        entity = f"{root}/{name}"
        picture = np.repeat(np.repeat(_colours(_levels(sigma, ends)), line, 0), wide, 1)
        stream.log(f"{entity}/map", rr.Image(picture), static=True)
        labels = rr.Points2D(
            places, labels=names, radii=0.1, colors=[(255, 255, 255)], show_labels=True
        )
        stream.log(f"{entity}/channels", labels, static=True)
        lines = [[(wide * (k + 0.5), 0.0), (wide * (k + 0.5), bottom)] for k in range(count)]
        cursor = rr.LineStrips2D.columns(strips=lines, colors=[(255, 255, 255)] * count)
        times = [rr.TimeColumn("sim_time", duration=moments)]
        stream.send_columns(f"{entity}/now", times, cursor)


def _levels(sigma: FloatArray, ends: np.ndarray[tuple[int], np.dtype[np.int_]]) -> FloatArray:
    """Rms of each stretch (c, stretches); 0 where a hole left nothing."""
    squares = np.square(np.nan_to_num(sigma))
    seen = np.isfinite(sigma).astype(float)
    sums = [np.add.reduceat(rows, ends[:-1], axis=0) for rows in (squares, seen)]
    return np.asarray(np.sqrt(sums[0] / np.maximum(sums[1], 1.0)).T)


def _colours(levels: FloatArray) -> np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]:
    """Red, green, blue (c, stretches, 3) on a logarithmic scale that the colour-blind can read."""
    from matplotlib import colormaps

    share = np.log(np.clip(levels, 1.0, HOTTEST)) / np.log(HOTTEST)
    return np.asarray(255.0 * colormaps["inferno"](share)[..., :3]).astype(np.uint8)
