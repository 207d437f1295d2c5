"""import: a lab file and its map become a recording."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.cli.limit import add_limit
from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ves_twin.core.signals import Signal
    from ves_twin.data.import_map import Window
    from ves_twin.data.suspicions import Range

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
        help="whose ranges tell mixed units; a rig of two files: whose signals they are, too",
    )
    add_limit(parser)
    parser.add_argument("--json", action="store_true", help="the account as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Import, write the recording, print the account."""
    from ves_twin.core.recording.files import save_recording
    from ves_twin.data.import_log import import_log
    from ves_twin.data.import_map import ImportMap
    from ves_twin.data.limits import Limits
    from ves_twin.data.open_log import open_log
    from ves_twin.simulator.simulate import make_folder

    told = ImportMap.load(arguments.map)
    window = _window(arguments, told.window)
    ranges, known = _plant(arguments.plant)
    path = _target(arguments.out)
    log = open_log(arguments.file, Limits.of(arguments.limit))
    imported = import_log(log, told, window, ranges, known)
    make_folder(path.parent)
    save_recording(imported.recording, path)
    if arguments.json:
        content = {**imported.account.to_dict(), "recording": str(path)}
        print(json_text(content))
    else:
        print(f"{imported.account.to_text()}\nrecording {path}")
    return 0


def _plant(name: str) -> tuple[Mapping[str, Range], Sequence[Signal]]:
    """Ranges of a plant's signals; of a rig of two files also the signals, which are its own."""
    from ves_twin.machines.mjcf.description import is_rig

    if is_rig(name):
        from ves_twin.machines.mjcf.machine import Rig
        from ves_twin.machines.mjcf.signals import rig_ranges, rig_signals

        rig = Rig.load(name)
        return rig_ranges(rig), rig_signals(rig)
    from ves_twin.plant.plant import Plant
    from ves_twin.plant.signal_ranges import signal_ranges

    return signal_ranges(Plant.load(name)), ()


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
    from ves_twin.data.import_map import Window

    start = told.start if arguments.start is None else to_si(arguments.start, "s", "--start")
    stop = told.stop if arguments.end is None else to_si(arguments.end, "s", "--end")
    if not 0.0 <= start < stop:
        raise InvalidInputError("--start and --end", f"{start:g} to {stop:g} s", "a stretch")
    return Window(start=start, stop=stop)
