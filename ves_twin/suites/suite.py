"""Suite: the public part of a blind suite: which cases, which plant, what a diagnosis may read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError
from ves_twin.core.whole_file import write_whole

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
        bench: which plant with which library: a name of BENCHES.
        cases: names, in order.
        excluded: case -> causes that its diagnosis must not consider.
        commissioned: recordings of other rigs in order.
        baseline: whether each case has one.
        schema: version.
    """

    bench: str
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
        write_whole(folder / FILE, json.dumps(asdict(self), indent=1) + "\n")


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
        return Suite(
            str(content["bench"]),
            tuple(map(str, content["cases"])),
            {case: tuple(map(str, names)) for case, names in content["excluded"].items()},
            int(content.get("commissioned", 0)),
            bool(content.get("baseline", False)),
        )
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        came = f"{type(error).__name__} at {error}"
        raise InvalidInputError(str(path), came, "bench, cases, excluded") from None


BENCHES = ("pendulum", "ves2", "ves2_fast")
"""Plants of blind suites: the pendulum; VES II with pressure hydraulics; the same in `fast`."""


def check_bench(name: str) -> None:
    """Refuse an unknown plant.

    Raises:
        UnknownNameError: not in BENCHES.
    """
    if name not in BENCHES:
        raise UnknownNameError("plant of blind suites", name, BENCHES)
