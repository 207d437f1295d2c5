"""open_machine: a machine by its name or file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.resources import resource_folder
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.machines.machine import Machine, Named
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.rig.load_description import is_rig, shipped_rigs
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.ves2.ves2_machine import Ves2Machine
from ves_twin.plant.plant import Plant

MODELS = (".xml", ".mjcf", ".urdf")
"""Ends of files that hold a model alone, without signals and tolerances."""

Given = Machine | Plant | Rig | str | Path | None
"""What names a machine: itself, what it is made of, or its name or file; None: VES II."""


def open_machine(
    name_or_path: str = "", mapping: ImportMap | None = None, folder: str | None = None
) -> Machine:
    """A shipped machine by name, or one of a file: a plant of VES II, or an MJCF machine.

    Args:
        name_or_path: VES II as its recordings say if empty.
        mapping: which column of a lab file is which signal.
        folder: of recordings that are not found by their path.

    Raises:
        VesTwinError: a name or file that does not exist, with the nearest, or a wrong file.
    """
    if not name_or_path:
        return Ves2Machine(mapping=mapping, folder=folder)
    if Path(name_or_path).suffix.lower() in MODELS and Path(name_or_path).is_file():
        expected = f"a machine's file; `ves-twin new {Path(name_or_path).name} LOG` drafts one"
        raise InvalidInputError(f"plant {name_or_path}", "a model", expected)
    if is_rig(name_or_path):
        return MjcfMachine(Rig.load(name_or_path), mapping, folder)
    path, plants = Path(name_or_path), shipped_plants()
    if not path.suffix and len(path.parts) == 1 and name_or_path not in plants:
        raise UnknownNameError("plant", name_or_path, (*plants, *shipped_rigs()))
    return Ves2Machine(Plant.load(name_or_path), mapping=mapping, folder=folder)


def shipped_plants() -> list[str]:
    """Names of the plants of VES II that come with the twin."""
    return sorted(path.stem for path in resource_folder("models").glob("*.toml"))


def shipped_machines() -> list[str]:
    """Names of the machines that come with the twin, beside the plants of VES II."""
    return shipped_rigs()


def machine_of(given: Given) -> Machine:
    """The machine that is meant.

    Raises:
        VesTwinError: as `open_machine`.
    """
    if isinstance(given, Machine):
        return given
    if isinstance(given, Plant):
        return Ves2Machine(given)
    if isinstance(given, Rig):
        return MjcfMachine(given)
    return open_machine(str(given or ""))


def named(recordings: Sequence[Recording | Named], word: str) -> tuple[Named, ...]:
    """Recordings with names: their own, else a word and a number from 1."""
    return tuple(
        one if isinstance(one, Named) else Named(f"{word} {number}", one)
        for number, one in enumerate(recordings, 1)
    )
