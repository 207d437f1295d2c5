"""Ledger: the folder of a sweep: what it is, and a line for each finished point.

A line is handed to the disk before the next one is written, so that a kill or a full disk costs
at most the points that were running.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import ExitStack
from io import FileIO
from pathlib import Path

from pydantic import ValidationError

from ves_twin.core.errors import FileAccessError, InvalidInputError, VesTwinError
from ves_twin.core.held_folder import hold_folder
from ves_twin.core.whole_file import write_whole
from ves_twin.sweeps.plan import SweepPlan
from ves_twin.sweeps.result import LOST, PointResult

IDENTITY_NAME = "sweep.json"
ROWS_NAME = "rows.jsonl"


class OtherSweepError(VesTwinError):
    """A folder that holds another sweep."""


class Ledger:
    """Rows of one sweep, each kept once; a context manager, since it holds a lock.

    Attributes:
        results: finished points by number; those that were lost are left out, to be tried again.

    Args:
        folder: folder of the sweep, made if it does not exist.
        plan: the sweep.

    Raises:
        OtherSweepError: the folder holds another sweep.
        InvalidInputError: rows that are not of this sweep.
        FileAccessError: it cannot be read or written, or another command writes it.
    """

    def __init__(self, folder: Path, plan: SweepPlan) -> None:
        self.results: dict[int, PointResult] = {}
        self._ids = [point.run_id for point in plan.points]
        self._path = folder / ROWS_NAME
        with ExitStack() as stack:
            stack.enter_context(hold_folder(folder))
            check_identity(folder, plan)
            try:
                self._file: FileIO = stack.enter_context(self._path.open("ab+", buffering=0))
            except OSError as error:
                raise FileAccessError(f"cannot write into '{folder}': {error.strerror}") from None
            write_whole(folder / IDENTITY_NAME, json.dumps(plan.identity, indent=2) + "\n")
            self._read()
            self._held = stack.pop_all()

    def keep(self, result: PointResult) -> bool:
        """Write a row to the disk; False for a point that is there already.

        Raises:
            FileAccessError: the disk refuses it; what was there stays whole.
        """
        if result.number in self.results:
            return False
        line = result.model_dump_json().encode() + b"\n"
        size = os.fstat(self._file.fileno()).st_size
        try:
            while line:  # a disk that is nearly full takes a part
                line = line[self._file.write(line) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            os.ftruncate(self._file.fileno(), size)
            raise FileAccessError(
                f"cannot write {self._path}: {error.strerror}; {len(self.results)} points are kept"
            ) from None
        if result.outcome != LOST:
            self.results[result.number] = result
        return True

    def __enter__(self) -> Ledger:
        return self

    def __exit__(self, *error: object) -> None:
        self._held.close()

    def _read(self) -> None:
        self._file.seek(0)
        content = self._file.read()
        whole = content.rfind(b"\n") + 1  # a line that a kill cut short is not a row
        for number, line in enumerate(content[:whole].splitlines(), 1):
            result = self._row(line, number)
            if result.outcome != LOST:
                self.results.setdefault(result.number, result)
        os.ftruncate(self._file.fileno(), whole)

    def _row(self, line: bytes, number: int) -> PointResult:
        try:
            result = PointResult.model_validate_json(line)
        except ValidationError:
            result = None
        if result is None or self._ids[result.number : result.number + 1] != [result.run_id]:
            where = f"{self._path} line {number}"
            raise InvalidInputError(where, line[:60].decode(errors="replace"), "a row of the sweep")
        return result


def check_identity(folder: Path, plan: SweepPlan) -> None:
    """Raise OtherSweepError where a folder holds a sweep that is not this one."""
    path = folder / IDENTITY_NAME
    if not path.exists():
        if (folder / ROWS_NAME).exists():
            raise OtherSweepError(f"'{folder}' holds rows without {IDENTITY_NAME}; give another")
        return
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        found = None
    if not isinstance(found, Mapping):
        raise InvalidInputError(str(path), "something else", "the identity of a sweep")
    for key, value in plan.identity.items():
        if found.get(key) != value:
            raise OtherSweepError(
                f"'{folder}' holds another sweep: its {key} is {_short(found.get(key))}, here it is"
                f" {_short(value)}; give another --out"
            )


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 90 else f"{text[:87]}..."
