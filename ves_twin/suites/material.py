"""Material: what a diagnosis may read of a case."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.suites.suite import (
    BASELINE,
    HELD_OUT,
    RECORDING,
    STANDSTILL,
    Suite,
    commissioning_file,
    next_file,
)


@dataclass(frozen=True)
class Use:
    """Which of the public recordings are used.

    Attributes:
        commissioning: those of other rigs in order.
        baseline: that of the same rig in order.
        after: the next experiment that was played, "proposed" or "random"; none if empty.
    """

    commissioning: bool = True
    baseline: bool = True
    after: str = ""


@dataclass(frozen=True)
class Material:
    """Recordings of one case, and of what belongs to all cases."""

    recordings: tuple[Recording, ...]
    held_out: tuple[Recording, ...]
    standstill: Recording | None
    commissioning: tuple[Recording, ...] = ()
    baseline: tuple[Recording, ...] = ()

    @staticmethod
    def in_folder(place: Path, standstill: bool) -> Material:
        """Of a single case, with its standstill in the same folder if there is one.

        Raises:
            FileAccessError: one is missing.
        """
        record, held_out = load_recording(place / RECORDING), load_recording(place / HELD_OUT)
        still = load_recording(place / STANDSTILL) if standstill else None
        return Material((record,), (held_out,), still)

    @staticmethod
    def of(folder: Path, suite: Suite, case: str, use: Use) -> Material:
        """Read them.

        Raises:
            FileAccessError: one is missing.
            InvalidInputError: too few commissioned rigs to tell anything.
        """
        place = folder / case
        own = Material.in_folder(place, standstill=False)
        after = (load_recording(place / next_file(use.after)),) if use.after else ()
        count = suite.commissioned if use.commissioning else 0
        has_baseline = suite.baseline and use.baseline
        return Material(
            (*own.recordings, *after),
            own.held_out,
            load_recording(folder / STANDSTILL),
            tuple(load_recording(folder / commissioning_file(k + 1)) for k in range(count)),
            (load_recording(place / BASELINE),) if has_baseline else (),
        )
