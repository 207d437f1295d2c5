"""rig_recordings: the rig and the recordings that a command names, where --plant is a rig."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.core.recording.recording import Recording
    from ves_twin.machines.mjcf.machine import Rig
    from ves_twin.machines.mjcf.tell import Told


@dataclass(frozen=True)
class RigRecordings:
    """Rigs and recordings, to fit and held out.

    Attributes:
        rig: that all recordings are of.
        measured: to fit.
        held_out: others.
        baseline: of the rig in order.
        rigs: of each measured one, which an experiment file may make differ.
        standstill: tells the noise; None if nobody named one.
    """

    rig: Rig
    measured: list[Recording]
    held_out: list[Recording]
    baseline: list[Recording]
    rigs: list[Rig]
    standstill: Recording | None


def add_rig_arguments(parser: argparse.ArgumentParser, alternate: bool = True) -> None:
    """Options that only rigs of two files have."""
    parser.add_argument("--data", metavar="DIR", help="folder of public data sets (rigs only)")
    parser.add_argument(
        "--map", metavar="MAP", help="which column of a log is which signal (TOML; rigs only)"
    )
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


def refuse_rig_options(arguments: argparse.Namespace) -> None:
    """Raise InvalidInputError where an option that only rigs have meets VES II."""
    from ves_twin.core.errors import InvalidInputError

    for option in ("data", "map", "alternate"):
        value = getattr(arguments, option, None)
        if value is not None:
            raise InvalidInputError(f"--{option}", value, "a rig of two files as --plant")


def means_rig(arguments: argparse.Namespace) -> bool:
    """Whether --plant, or the experiment's plant without it, names a rig of two files."""
    named = rig_name(arguments)
    if not named:
        return False
    from ves_twin.machines.mjcf.description import is_rig

    return is_rig(named)


def rig_name(arguments: argparse.Namespace) -> str:
    """What --plant says, or else the experiment file; a path there starts from that file."""
    if arguments.plant or not getattr(arguments, "experiment", None):
        return arguments.plant or ""
    from ves_twin.core.toml_file import read_toml

    path = Path(arguments.experiment)
    named = read_toml("experiment", path)[0].get("plant")
    if not isinstance(named, str):
        return ""
    beside = path.parent / named
    return str(beside) if beside.suffix and beside.is_file() else named


def rig_recordings(
    arguments: argparse.Namespace, names: Sequence[str], alike: bool = True
) -> RigRecordings:
    """Read the files of a command, and apply its experiment file.

    Args:
        arguments: of a command with `add_rig_arguments`.
        names: of the measured recordings.
        alike: whether one rig must have made all of them.

    Raises:
        VesTwinError: a file that is missing or wrong, or recordings of one name.
    """
    from ves_twin.machines.mjcf.interleaved_split import alternate
    from ves_twin.machines.mjcf.machine import Rig

    rig = Rig.load(rig_name(arguments))
    held, usual = (list(getattr(arguments, name, [])) for name in ("held_out", "baseline"))
    read = [read_file(arguments, rig, name) for name in (*names, *held, *usual)]
    rigs, still = [rig] * len(read), getattr(arguments, "standstill", None)
    if getattr(arguments, "experiment", None):
        told = _told(arguments, (*names, *held, *usual), read, rig)
        read, rigs = list(told.recordings), list(told.rigs)
        rig = told.rig if alike else rig
        still = still or told.standstill
    measured, baseline = read[: len(names)], read[len(names) + len(held) :]
    held_out = read[len(names) :][: len(held)]
    length = getattr(arguments, "alternate", None)
    if length is not None:
        pairs = [alternate(r, length or rig.description.block) for r in measured]
        measured = [piece for fitted, _ in pairs for piece in fitted]
        held_out += [piece for _, held_back in pairs for piece in held_back]
    standstill = read_file(arguments, rig, still) if still else None
    return RigRecordings(rig, measured, held_out, baseline, rigs[: len(names)], standstill)


def read_file(arguments: argparse.Namespace, rig: Rig, name: str | Path) -> Recording:
    """One recording of a rig, from its path or from the folder of public data."""
    from ves_twin.data.import_map import ImportMap
    from ves_twin.machines.mjcf.data_folder import find_data
    from ves_twin.machines.mjcf.read import read_recording

    told = ImportMap.load(arguments.map) if arguments.map else None
    path = Path(name) if Path(name).is_dir() else find_data(str(name), rig, arguments.data)
    recording = read_recording(path, rig, told)
    suspected = recording.info.imported.get("suspected", ())
    for words in suspected if isinstance(suspected, list | tuple) else ():
        print(f"suspected: {words}", file=sys.stderr)
    return recording


def _told(
    arguments: argparse.Namespace, names: Sequence[str], read: Sequence[Recording], rig: Rig
) -> Told:
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.core.recording.files import recording_name
    from ves_twin.machines.mjcf.experiment import RigExperiment
    from ves_twin.machines.mjcf.tell import tell

    named = dict(zip(map(recording_name, names), read, strict=True))
    if len(named) < len(read):
        raise InvalidInputError("recordings", "two of one name", "names that tell them apart")
    return tell(named, RigExperiment.load(arguments.experiment), rig)
