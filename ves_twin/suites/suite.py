"""Suite: the public part of a blind suite: which cases, what machine, what a diagnosis reads."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError
from ves_twin.core.whole_file import write_whole
from ves_twin.machines.mjcf.rig.load_description import shipped_rigs

SCHEMA = 1
"""Version of suite.json."""

FILE = "suite.json"
STANDSTILL, RECORDING, HELD_OUT = "standstill.parquet", "recording.parquet", "held_out.parquet"
BASELINE = "baseline.parquet"


def commissioning_file(number: int) -> str:
    """Recording of a rig in order, counted from 1."""
    return f"commissioning-{number:02d}.parquet"


def next_file(choice: str) -> str:
    """Recording of a next experiment: the proposed one, or one at random."""
    return f"next-{choice}.parquet"


@dataclass(frozen=True)
class Suite:
    """What everybody may know.

    Attributes:
        machine: a name that `check_machine` knows, or the file of an MJCF machine.
        cases: names, in order.
        excluded: case -> causes that its diagnosis must not consider.
        commissioned: recordings of other rigs in order.
        baseline: whether each case has one.
        schema: version.
    """

    machine: str
    cases: tuple[str, ...]
    excluded: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    commissioned: int = 0
    baseline: bool = False
    schema: int = SCHEMA

    def save(self, folder: Path) -> None:
        """Write suite.json.

        Raises:
            FileAccessError: not writable.
        """
        content = asdict(self) | {"machine": from_folder(self.machine, folder)}
        write_whole(folder / FILE, json.dumps(content, indent=1) + "\n")


def load_suite(folder: Path) -> Suite:
    """Read suite.json of a folder.

    Raises:
        FileAccessError: there is none.
        InvalidInputError: not a suite.
    """
    path = folder / FILE
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileAccessError(f"cannot read {path}: {error.strerror}") from None
    except ValueError:
        raise InvalidInputError(str(path), "no JSON", "what `ves-twin blind make` writes") from None
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        raise InvalidInputError(str(path), content, f"a suite of schema {SCHEMA}")
    try:
        name = str(content["machine"] if "machine" in content else content["bench"])
        return Suite(
            str(folder / name) if _is_file(name) else name,
            tuple(map(str, content["cases"])),
            {case: tuple(map(str, names)) for case, names in content["excluded"].items()},
            int(content.get("commissioned", 0)),
            bool(content.get("baseline", False)),
        )
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        came = f"{type(error).__name__} at {error}"
        raise InvalidInputError(str(path), came, "machine, cases, excluded") from None


OF_VES2 = {"ves2": "ves2_pressure", "ves2_fast": "ves2_pressure_fast"}
"""VES II in blind suites: with pressure hydraulics, and the same in `fast`."""


def check_machine(name: str) -> None:
    """Refuse an unknown machine.

    Raises:
        UnknownNameError: neither VES II, nor a shipped MJCF machine, nor a TOML file.
    """
    known = (*shipped_rigs(), *OF_VES2)
    if not _is_file(name) and name not in known:
        raise UnknownNameError("machine of blind suites", name, known)


def from_folder(name: str, folder: Path) -> str:
    """A machine's file as seen from a folder, so that both can be moved together; a name as is."""
    return os.path.relpath(name, folder) if _is_file(name) else name


def _is_file(name: str) -> bool:
    return Path(name).suffix == ".toml"
