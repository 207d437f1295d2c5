"""trend: a folder of recordings of one rig on different days to what changed, and since when."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.diagnosis.trend.calendar import Calendar
    from ves_twin.diagnosis.trend.result import DaySize, Trend
    from ves_twin.machines.machine import Named

from ves_twin.cli.given import Given, add_machine_options, bank_settings

SUMMARY = "follow one cause over recordings of different days: constant, step, ramp, and since when"

SUFFIXES = (
    *(".csv", ".txt", ".tsv", ".gz", ".bz2", ".mat", ".npz", ".npy", ".mcap"),
    *(".parquet", ".feather", ".arrow", ".arrows"),
)
"""Endings of files in a folder that count as recordings."""

JSON_NAME, PAGE_NAME = "trend.json", "report.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "measured", metavar="FOLDER|FILE", nargs="+", help="recordings of one rig, dated by name"
    )
    add_machine_options(parser)
    parser.add_argument(
        "--cause", metavar="EFFECT@TARGET", default="", help="follow this one, whatever else"
    )
    parser.add_argument(
        "--exclude", metavar="EFFECT", action="append", default=[], help="a cause not considered"
    )
    parser.add_argument(
        "--false-alarm",
        metavar="RATE",
        type=float,
        default=0.01,
        help="of unchanged machines, how many may be called changed",
    )
    parser.add_argument(
        "--numbered", action="store_true", help="ignore dates: in order of the names"
    )
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/trend)")
    parser.add_argument("--json", action="store_true", help="the trend as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Read, follow, write page and JSON, print the answer."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.trend import trend
    from ves_twin.report.diagnosis.trend_page import trend_page
    from ves_twin.report.page import write_page

    with output_folder(arguments.out, "trend") as held:
        given = Given.of(arguments)
        measured = given.read(recordings_in(arguments.measured))
        calendar = _calendar(measured, arguments.numbered)
        with RunProgress("trend", 1.0, unit="share") as progress:
            found = trend(
                measured,
                given.machine,
                calendar=calendar,
                standstill=given.standstill(arguments.standstill),
                exclude=arguments.exclude,
                cause=arguments.cause,
                false_alarm=arguments.false_alarm,
                experiment=given.experiment,
                settings=bank_settings(),
                progress=progress.share,
            )
        found.save(held.path / JSON_NAME)
        title = f"Trend of {len(measured)} recordings of {given.machine.name}"
        write_page(held.path / PAGE_NAME, trend_page(found, title))
    print(found.to_json() if arguments.json else _text(found, held.path))
    return 0


def recordings_in(given: Sequence[str]) -> list[str]:
    """Files as they are named, and those in folders that look like recordings, by name.

    Raises:
        FileAccessError: a folder without one.
    """
    from ves_twin.core.errors import FileAccessError
    from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME

    found: list[str] = []
    for name in given:
        folder = Path(name)
        whole = any((folder / one).is_file() for one in (FILE_NAME, STREAM_NAME))
        if not folder.is_dir() or whole:
            found.append(name)
            continue
        inside = [p for p in sorted(folder.iterdir()) if _is_recording(p)]
        if not inside:
            raise FileAccessError(
                f"folder {name} holds no recording; {', '.join(sorted(SUFFIXES))}"
            )
        found += [str(path) for path in inside]
    return found


def _is_recording(path: Path) -> bool:
    from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME

    if path.name.startswith("."):
        return False
    if path.is_dir():
        return any((path / one).is_file() for one in (FILE_NAME, STREAM_NAME))
    return path.suffix.lower() in SUFFIXES


def _calendar(measured: Sequence[Named], numbered: bool) -> Calendar:
    from ves_twin.core.recording.date_of import date_of
    from ves_twin.diagnosis.trend.calendar import Calendar

    dates = [None if numbered else date_of(one.name, one.recording) for one in measured]
    return Calendar.of([one.name for one in measured], dates)


def _text(trend: Trend, folder: Path) -> str:
    from ves_twin.core.quantity import quantity
    from ves_twin.report.diagnosis.trend_words import trend_basis, trend_headline

    lines = [f"answer    {trend.answer.value}", f"          {trend_headline(trend)}", ""]
    if trend.cause is not None:
        names = _named(trend.sizes)
        width = max(map(len, names))
        unit = trend.cause.unit
        for name, size in zip(names, trend.sizes, strict=True):
            span = f"{quantity(size.low, unit)} to {quantity(size.high, unit)}"
            mark = "" if size.explained else "   not explained"
            value = quantity(size.value, unit)
            lines.append(f"  {name:<{width}}  {value:>12}  ({span}){mark}")
        lines.append("")
    lines += [f"  {said}" for said in trend_basis(trend)]
    return "\n".join([*lines, f"  files     {folder}/{PAGE_NAME}, {JSON_NAME}"])


def _named(sizes: Sequence[DaySize]) -> list[str]:
    """Recording and date of each size; the date alone where recordings are called by it."""
    if all(size.recording == size.date for size in sizes):
        return [size.date for size in sizes]
    width = max(len(size.recording) for size in sizes)
    return [f"{size.recording:<{width}}  {size.date}" for size in sizes]
