"""Given: the machine, the experiment and the recordings that a command names."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.core.recording.recording import Recording
    from ves_twin.diagnosis.settings import Settings
    from ves_twin.machines.machine import Machine, Named
    from ves_twin.scenario.experiment_file import ExperimentFile


@dataclass(frozen=True)
class Given:
    """What a command's options name.

    Attributes:
        machine: of `--plant`, else of the experiment, else VES II as it was recorded.
        experiment: how recordings were made; None if nobody says.
    """

    machine: Machine
    experiment: ExperimentFile | None

    @staticmethod
    def of(arguments: argparse.Namespace) -> Given:
        """Of a command with `add_machine_options`.

        Raises:
            VesTwinError: a machine, map or experiment that is missing or wrong.
        """
        from ves_twin.data.mapping.import_map import ImportMap
        from ves_twin.machines.load import open_machine

        mapping = ImportMap.load(arguments.map) if arguments.map else None
        machine = open_machine(_machine_name(arguments), mapping, arguments.data)
        path = arguments.experiment
        return Given(machine, machine.experiment(path) if path else None)

    def read(self, names: Sequence[str]) -> tuple[Named, ...]:
        """Recordings by their files; what an import suspects goes to stderr."""
        from ves_twin.core.recording.files import recording_name
        from ves_twin.machines.machine import Named

        return tuple(Named(recording_name(name), self.read_one(name)) for name in names)

    def read_one(self, name: str) -> Recording:
        """One of them."""
        recording = self.machine.read(name)
        suspected = recording.info.imported.get("suspected", ())
        for words in suspected if isinstance(suspected, list | tuple) else ():
            print(f"suspected: {words}", file=sys.stderr)
        return recording

    def standstill(self, name: str | None) -> Recording | None:
        """The recording that tells the noise; None if nobody names one."""
        return self.read_one(name) if name else None


def add_machine_options(parser: argparse.ArgumentParser) -> None:
    """Options that say which machine was recorded, and how."""
    parser.add_argument(
        "--plant", metavar="FILE", help="the machine: a name, a plant of VES II, an MJCF machine"
    )
    parser.add_argument("--experiment", metavar="FILE", help="how they were made (TOML)")
    parser.add_argument("--data", metavar="DIR", help="folder of recordings, as public data sets")
    parser.add_argument("--map", metavar="MAP", help="which column of a log is which signal (TOML)")
    parser.add_argument("--standstill", metavar="REC", help="the machine standing still: its noise")


def bank_settings() -> Settings:
    """All cores, banks kept beside the compiled code."""
    from ves_twin.core.cache_folder import cache_folder
    from ves_twin.diagnosis.settings import Settings

    return Settings(workers=os.cpu_count() or 1, cache=cache_folder("diagnosis"))


RECORDINGS = ("measured", "recordings", "held_out", "baseline", "commissioning", "against")
"""Arguments of commands that name recordings."""


def refuse_missing(arguments: argparse.Namespace) -> None:
    """Say that a file is not there before what reads it is imported, which takes seconds.

    Names of shipped machines, and files that may lie in a folder of public data, are left to
    whoever knows them.

    Args:
        arguments: of any command; recordings are those of commands with `add_machine_options`.

    Raises:
        FileAccessError: a machine's file or a recording that is not there.
    """
    from ves_twin.core.missing_file import missing_file
    from ves_twin.core.resources import find_resource

    plant = getattr(arguments, "plant", None) or ""
    if Path(plant).suffix:
        find_resource("plant", "models", plant)
    if not hasattr(arguments, "data") or not hasattr(arguments, "experiment"):
        return
    if arguments.data or os.environ.get("VES_TWIN_DATA") or (plant and not Path(plant).suffix):
        return
    for option in RECORDINGS:
        given = getattr(arguments, option, None) or ()
        for name in (given,) if isinstance(given, str) else given:
            if not os.path.lexists(name):
                raise missing_file("recording", name)


def _machine_name(arguments: argparse.Namespace) -> str:
    """What --plant says, or else the experiment file; a path there starts from that file."""
    if arguments.plant or not arguments.experiment:
        return arguments.plant or ""
    from ves_twin.core.toml_file import read_toml

    path = Path(arguments.experiment)
    named = read_toml("experiment", path)[0].get("plant")
    if not isinstance(named, str):
        return ""
    beside = path.parent / named
    return str(beside) if beside.suffix and beside.is_file() else named
