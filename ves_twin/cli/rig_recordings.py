"""rig_recordings: the rig and the recordings that a command names, where --plant is a rig."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.recording.recording import Recording
    from ves_twin.rigs.rig import Rig


@dataclass(frozen=True)
class RigRecordings:
    """The rig, recordings to fit, and recordings held out."""

    rig: Rig
    measured: list[Recording]
    held_out: list[Recording]


def add_rig_arguments(parser: argparse.ArgumentParser, alternate: bool = True) -> None:
    """Options that only rigs of two files have."""
    parser.add_argument("--data", metavar="DIR", help="folder of public data sets (rigs only)")
    if not alternate:
        return
    parser.add_argument(
        "--alternate",
        metavar="LENGTH",
        nargs="?",
        type=float,
        const=0.0,
        help="hold out every second stretch of LENGTH s, or poses, of each recording (rigs only;"
        " without LENGTH: that of the rig's file)",
    )


def means_rig(arguments: argparse.Namespace) -> bool:
    """Whether --plant names a rig of two files."""
    if not arguments.plant:
        return False
    from ves_twin.rigs.description import is_rig

    return is_rig(arguments.plant)


def rig_recordings(arguments: argparse.Namespace, names: list[str]) -> RigRecordings:
    """Read the files of a command.

    Raises:
        VesTwinError: a file that is missing or wrong.
    """
    from ves_twin.rigs.alternate import alternate
    from ves_twin.rigs.rig import Rig

    rig = Rig.load(arguments.plant)
    measured = [read_file(arguments, rig, name) for name in names]
    held_out = [read_file(arguments, rig, name) for name in getattr(arguments, "held_out", [])]
    length = getattr(arguments, "alternate", None)
    if length is not None:
        pairs = [alternate(r, length or rig.description.block) for r in measured]
        measured = [piece for fitted, _ in pairs for piece in fitted]
        held_out += [piece for _, held in pairs for piece in held]
    return RigRecordings(rig, measured, held_out)


def read_file(arguments: argparse.Namespace, rig: Rig, name: str | Path) -> Recording:
    """One recording of a rig, from its path or from the folder of public data."""
    from ves_twin.rigs.columns import read_rig_recording
    from ves_twin.rigs.data_folder import find_data

    return read_rig_recording(find_data(str(name), rig, arguments.data), rig)
