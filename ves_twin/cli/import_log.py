"""import: a lab file and its map become a recording."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.cli.limit import add_limit
from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.data.mapping.import_map import Window

SUMMARY = "make a recording of a lab file as a map says"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("file", metavar="FILE", help="CSV, Parquet, Arrow, MAT, npz or MCAP")
    parser.add_argument("--map", metavar="MAP", required=True, help="which column is what (TOML)")
    parser.add_argument("--start", metavar="S", help="first second, from the first row on")
    parser.add_argument("--end", metavar="S", help="last second")
    parser.add_argument("--out", metavar="REC", required=True, help="the recording (Parquet)")
    parser.add_argument(
        "--plant",
        metavar="FILE",
        default="ves2",
        help="whose ranges tell mixed units; an MJCF machine: whose signals they are, too",
    )
    add_limit(parser)
    parser.add_argument("--json", action="store_true", help="the account as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Import, write the recording, print the account."""
    from ves_twin.core.held_folder import hold_file
    from ves_twin.core.recording.files import save_recording
    from ves_twin.data.formats.limits import Limits
    from ves_twin.data.formats.open_log import open_log
    from ves_twin.data.import_log import import_log
    from ves_twin.data.mapping.import_map import ImportMap
    from ves_twin.machines.load import open_machine

    path = _target(arguments.out)
    with hold_file(path):
        told = ImportMap.load(arguments.map)
        window = _window(arguments, told.window)
        machine = open_machine(arguments.plant)
        log = open_log(arguments.file, Limits.of(arguments.limit))
        imported = import_log(log, told, window, machine.ranges, machine.own_signals)
        save_recording(imported.recording, path)
    if arguments.json:
        content = {**imported.account.to_dict(), "recording": str(path)}
        print(json_text(content))
    else:
        print(f"{imported.account.to_text()}\nrecording {path}")
    return 0


def _target(out: str) -> Path:
    from ves_twin.core.errors import InvalidInputError

    path = Path(out)
    if path.is_dir():
        return path / "recording.parquet"
    if path.suffix != ".parquet":
        raise InvalidInputError("--out", out, "a file that ends in .parquet, or a folder")
    return path


def _window(arguments: argparse.Namespace, told: Window) -> Window:
    """The map's window with what the command says instead."""
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.core.units import to_si
    from ves_twin.data.mapping.import_map import Window

    start = told.start if arguments.start is None else to_si(arguments.start, "s", "--start")
    stop = told.stop if arguments.end is None else to_si(arguments.end, "s", "--end")
    if not 0.0 <= start < stop:
        raise InvalidInputError("--start and --end", f"{start:g} to {stop:g} s", "a stretch")
    return Window(start=start, stop=stop)
