"""write_gif: a recording as a moving picture."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import IntArray
from ves_twin.core.whole_file import check_writable, whole_file
from ves_twin.envs.picture import Picture, check_off_screen
from ves_twin.plant.statics import place_rig
from ves_twin.report.rerun.poses import MACHINE_ARM, MACHINE_POSE, first_present
from ves_twin.report.rerun.rig import DrawnRig

FRAME = 0.08
"""Time between two pictures [s]; the format counts in hundredths."""

LONGEST = 120.0
"""Longest recording that is drawn [s]; some 30 MB."""

COLOURS = 128
"""Of the palette of a picture."""


def check_video(path: Path, duration: float = 0.0) -> None:
    """Refuse before a run what could not be written after it.

    Args:
        path: the .gif file.
        duration: of the run [s].

    Raises:
        InvalidInputError: another ending than .gif, or a run longer than LONGEST.
        FileAccessError: the file cannot be written.
        NoPictureError: no OpenGL that draws off screen.
    """
    if path.suffix.lower() != ".gif":
        raise InvalidInputError("video", path.name, "FILE.gif; other forms need an encoder")
    if duration > LONGEST:
        raise InvalidInputError("video", f"{duration:.0f} s", f"at most {LONGEST:g} s, to draw")
    check_writable(path)
    check_off_screen()


def write_gif(recording: Recording, path: Path) -> int:
    """Draw the rig along a recording in real time; legs straight, bending too small to see.

    Args:
        recording: measured or simulated.
        path: the .gif file; one that exists is replaced.

    Returns:
        Number of pictures.

    Raises:
        InvalidInputError: another ending, a recording without rows, or a longer one than LONGEST.
        NoPictureError: no OpenGL that draws off screen.
        FileAccessError: the file cannot be written.
    """
    check_video(path)
    rows = _rows(recording)
    pictures = _pictures(recording, rows)
    first = next(pictures)
    with whole_file(path) as partial:
        first.save(
            partial,
            format="GIF",
            save_all=True,
            append_images=pictures,
            duration=round(1000 * FRAME),
            loop=0,
            optimize=False,
        )
    return len(rows)


def _rows(recording: Recording) -> IntArray:
    """Rows nearest after a regular grid (n,)."""
    if not len(recording):
        raise InvalidInputError("recording", "0 rows", "one or more, to draw")
    length = float(recording.time[-1] - recording.time[0])
    if length > LONGEST:
        raise InvalidInputError("recording", f"{length:.0f} s", f"at most {LONGEST:g} s, to draw")
    grid = np.arange(recording.time[0], recording.time[-1] + 1e-9, FRAME)  # the last row counts
    return np.searchsorted(recording.time, grid).clip(max=len(recording) - 1).astype(np.int64)


def _pictures(recording: Recording, rows: IntArray) -> Iterator[Image.Image]:
    rig = DrawnRig.of(recording.info)
    data = mujoco.MjData(rig.model)
    pose = np.nan_to_num(first_present(recording, MACHINE_POSE, 6))
    joints = np.nan_to_num(first_present(recording, MACHINE_ARM, 3))
    picture = Picture(window=False)
    try:
        for row in rows:
            place_rig(data, rig.layout, rig.geometry, pose[row], joints[row])
            pixels = picture.show(rig.model, data)
            yield Image.fromarray(pixels).quantize(COLOURS)  # type: ignore[arg-type]
    finally:
        picture.close()
