"""write_rrd: a recording as a rerun file: 3-D, plots, events, account and their layout."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import rerun as rr

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import IntArray
from ves_twin.core.whole_file import whole_file
from ves_twin.report.rerun.account import account
from ves_twin.report.rerun.blueprint import blueprint_of
from ves_twin.report.rerun.colours import GHOST
from ves_twin.report.rerun.poses import (
    GHOST_ARM,
    GHOST_POSE,
    MACHINE_ARM,
    MACHINE_POSE,
    body_frames,
)
from ves_twin.report.rerun.rig import DrawnRig
from ves_twin.report.rerun.series import Series, series_of
from ves_twin.report.rerun.shapes import send_shapes
from ves_twin.simulator.outcome import Outcome

ROWS_PER_CHUNK = 20_000
"""Rows sent at a time: a megabyte per six columns."""

GHOST_PARTS = ("platform/", "sensor/", "arm/")
"""Prefixes of the bodies that the zero-g reference has; it knows no legs."""

GHOST_GROWTH = 0.004
"""Thickness [m] by which the ghost covers a machine that follows it without error."""

FAILURES = frozenset(set(Outcome) - {Outcome.COMPLETED})


def write_rrd(recording: Recording, path: Path) -> Path:
    """Write a recording as a rerun file, for the viewer of the same release.

    Timelines are `sim_time` [s] and `row`. The file takes its name only once it is whole.

    Args:
        recording: measured or simulated.
        path: the .rrd file; one that exists is replaced.

    Returns:
        The path.

    Raises:
        FileAccessError: the file cannot be written.
    """
    with whole_file(path) as partial:
        _write(recording, partial)
    return path


def _write(recording: Recording, path: Path) -> None:
    rig = DrawnRig.of(recording.info)
    series = series_of(recording)
    name = recording.info.scenario or "recording"
    # the viewer keeps one layout per application, so runs of unlike scenarios must differ in it
    stream = rr.RecordingStream(f"ves_twin {name}")
    blueprint = blueprint_of(frozenset(s.entity for s in series))
    # the library's own file writer can wait for ever on a full disk; a .rrd is as large as its rows
    content = stream.binary_stream()
    # a default alone is not taken up where the file comes over the network: `view --web`
    stream.send_blueprint(blueprint, make_active=True, make_default=True)
    stream.send_recording_name(f"{name}, seed {recording.info.seed}")
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    page = rr.TextDocument(account(recording, rig.note), media_type=rr.MediaType.MARKDOWN)
    stream.log("account", page, static=True)
    _send_events(stream, recording)
    _send_machine(stream, recording, rig)
    if "reference.pose" in recording.signals:
        _send_ghost(stream, recording, rig)
    for lines in series:
        _send_series(stream, recording, lines)
    path.write_bytes(content.read() or b"")
    stream.disconnect()


def _send_machine(stream: rr.RecordingStream, recording: Recording, rig: DrawnRig) -> None:
    send_shapes(stream, "machine", rig.model, ("world", *rig.bodies))
    _send_frames(stream, recording, rig, "machine", (MACHINE_POSE, MACHINE_ARM), rig.bodies)


def _send_ghost(stream: rr.RecordingStream, recording: Recording, rig: DrawnRig) -> None:
    bodies = tuple(body for body in rig.bodies if body.startswith(GHOST_PARTS))
    send_shapes(stream, "ghost", rig.model, bodies, GHOST, GHOST_GROWTH)
    _send_frames(stream, recording, rig, "ghost", (GHOST_POSE, GHOST_ARM), bodies)


def _send_frames(
    stream: rr.RecordingStream,
    recording: Recording,
    rig: DrawnRig,
    root: str,
    signals: tuple[tuple[str, ...], tuple[str, ...]],
    bodies: tuple[str, ...],
) -> None:
    for frames in body_frames(recording, rig, *signals):
        times = _times(recording, frames.rows)
        for body in bodies:
            i = rig.bodies.index(body)
            poses = rr.Transform3D.columns(
                translation=frames.position[:, i], quaternion=frames.turn[:, i]
            )
            stream.send_columns(f"{root}/{body}", times, poses)


def _send_series(stream: rr.RecordingStream, recording: Recording, lines: Series) -> None:
    style = rr.SeriesLines(names=lines.names, colors=lines.colours, widths=[1.5] * len(lines.names))
    stream.log(lines.entity, style, static=True)
    for rows in _chunks(len(recording)):
        times = _times(recording, np.arange(rows.start, rows.stop))
        stream.send_columns(lines.entity, times, rr.Scalars.columns(scalars=lines.values(rows)))


def _send_events(stream: rr.RecordingStream, recording: Recording) -> None:
    events = recording.info.events
    if not events:
        return
    at = np.array([event.time for event in events])
    rows = np.clip(np.searchsorted(recording.time, at), 0, max(len(recording) - 1, 0))
    levels = [rr.TextLogLevel.ERROR if e.kind in FAILURES else rr.TextLogLevel.INFO for e in events]
    texts = [f"{event.kind}: {event.message}" for event in events]
    times = [rr.TimeColumn("sim_time", duration=at), rr.TimeColumn("row", sequence=rows)]
    stream.send_columns("events", times, rr.TextLog.columns(text=texts, level=levels))


def _chunks(count: int) -> Iterator[slice]:
    for start in range(0, count, ROWS_PER_CHUNK):
        yield slice(start, min(start + ROWS_PER_CHUNK, count))


def _times(recording: Recording, rows: IntArray) -> list[rr.TimeColumn]:
    return [
        rr.TimeColumn("sim_time", duration=recording.time[rows]),
        rr.TimeColumn("row", sequence=rows),
    ]
