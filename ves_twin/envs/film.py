"""write_film: a recording as a moving picture, with the time in it and curves beside."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ves_twin.core.errors import InvalidInputError, VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import IntArray
from ves_twin.core.whole_file import check_writable, whole_file
from ves_twin.envs.picture import HEIGHT, WIDTH, Picture, check_off_screen
from ves_twin.plant.statics import place_rig
from ves_twin.report.rerun.poses import MACHINE_ARM, MACHINE_POSE, first_present
from ves_twin.report.rerun.rig import DrawnRig

if TYPE_CHECKING:
    from types import ModuleType

FRAMES = {".gif": 0.08, ".mp4": 0.04}
"""Time between two pictures [s] of each form; GIF counts in hundredths."""

LONGEST = 120.0
"""Longest recording that is drawn [s]; some 40 MB as GIF, a tenth of it as mp4."""

COLOURS = 128
"""Of the palette of a picture of a GIF, chosen so that thin lines keep theirs."""

BESIDE = 440
"""Width of the curves beside the rig [pixels]."""

QUALITY = "20"
"""Constant rate factor of mp4; 23 is usual, lower is better: thin lines stay sharp."""


def check_video(path: Path, duration: float = 0.0) -> None:
    """Refuse before a run what could not be written after it.

    Args:
        path: the .gif or .mp4 file.
        duration: of the run [s].

    Raises:
        InvalidInputError: another ending, or a run longer than LONGEST.
        FileAccessError: the file cannot be written.
        NoPictureError: no OpenGL that draws off screen.
        VesTwinError: mp4 without the extra `video`.
    """
    if path.suffix.lower() not in FRAMES:
        raise InvalidInputError("video", path.name, "FILE.mp4 or FILE.gif")
    if duration > LONGEST:
        raise InvalidInputError("video", f"{duration:.0f} s", f"at most {LONGEST:g} s, to draw")
    if path.suffix.lower() == ".mp4":
        _encoder()
    check_writable(path)
    check_off_screen()


def write_film(recording: Recording, path: Path) -> int:
    """Draw the rig along a recording in real time; legs straight, bending too small to see.

    Args:
        recording: measured or simulated.
        path: the .gif or .mp4 file; one that exists is replaced.

    Returns:
        Number of pictures.

    Raises:
        InvalidInputError: another ending, a recording without rows, or a longer one than LONGEST.
        NoPictureError: no OpenGL that draws off screen.
        FileAccessError: the file cannot be written.
        VesTwinError: mp4 without the extra `video`.
    """
    check_video(path)
    period = FRAMES[path.suffix.lower()]
    rows = _rows(recording, period)
    pictures = _pictures(recording, rows)
    first = next(pictures)  # what cannot be drawn fails before a file is begun
    with whole_file(path) as partial:
        write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
        write(chain([first], pictures), partial, period)
    return len(rows)


def _rows(recording: Recording, period: float) -> IntArray:
    """Rows nearest after a regular grid (n,)."""
    if not len(recording):
        raise InvalidInputError("recording", "0 rows", "one or more, to draw")
    length = float(recording.time[-1] - recording.time[0])
    if length > LONGEST:
        raise InvalidInputError("recording", f"{length:.0f} s", f"at most {LONGEST:g} s, to draw")
    grid = np.arange(recording.time[0], recording.time[-1] + 1e-9, period)  # the last row counts
    return np.searchsorted(recording.time, grid).clip(max=len(recording) - 1).astype(np.int64)


def _pictures(recording: Recording, rows: IntArray) -> Iterator[Image.Image]:
    """The rig with the time on it, and the curves beside it, at each row."""
    from ves_twin.envs.film_curves import FilmCurves  # matplotlib is slow to import

    rig = DrawnRig.of(recording.info)
    data = mujoco.MjData(rig.model)
    pose = np.nan_to_num(first_present(recording, MACHINE_POSE, 6))
    joints = np.nan_to_num(first_present(recording, MACHINE_ARM, 3))
    curves = FilmCurves.of(recording, BESIDE, HEIGHT)
    font = ImageFont.load_default(22)
    picture = Picture(window=False)
    try:
        for row in rows:
            place_rig(data, rig.layout, rig.geometry, pose[row], joints[row])
            time = float(recording.time[row])
            frame = Image.new("RGB", (WIDTH + BESIDE, HEIGHT))
            pixels = picture.show(rig.model, data)
            frame.paste(Image.fromarray(pixels), (0, 0))  # type: ignore[arg-type]
            frame.paste(Image.fromarray(curves.at(time)), (WIDTH, 0))
            said = f"{time:.2f} s"
            ImageDraw.Draw(frame).text((14, 10), said, "white", font, stroke_width=2, stroke_fill=0)
            yield frame
    finally:
        picture.close()


def _write_gif(pictures: Iterator[Image.Image], path: Path, period: float) -> None:
    counted = (p.quantize(COLOURS, Image.Quantize.MAXCOVERAGE) for p in pictures)
    next(counted).save(
        path,
        format="GIF",
        save_all=True,
        append_images=counted,
        duration=round(1000 * period),
        loop=0,
        optimize=False,
    )


def _write_mp4(pictures: Iterator[Image.Image], path: Path, period: float) -> None:
    """H.264 with half of the colour's resolution, which every browser plays."""
    av = _encoder()
    with av.open(path, "w", format="mp4", options={"movflags": "faststart"}) as film:
        rate = Fraction(1) / Fraction(str(period))
        stream = film.add_stream("libx264", rate=rate, options={"crf": QUALITY})
        stream.width, stream.height, stream.pix_fmt = WIDTH + BESIDE, HEIGHT, "yuv420p"
        for picture in pictures:
            film.mux(stream.encode(av.VideoFrame.from_image(picture)))
        film.mux(stream.encode())


def _encoder() -> ModuleType:
    try:
        import av
    except ImportError as error:
        raise VesTwinError(
            "mp4 needs the extra `video`: pip install 'ves_twin[video]'; FILE.gif needs none"
        ) from error
    return av  # type: ignore[no-any-return]
