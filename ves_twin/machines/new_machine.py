"""new_machine: the file of a new machine, drafted from its model and a log of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path

from ves_twin.core.errors import FileAccessError
from ves_twin.core.held_folder import HeldFolder, hold_file
from ves_twin.core.whole_file import write_whole
from ves_twin.machines.mjcf.draft.draft import Draft, draft


@dataclass(frozen=True)
class NewMachine:
    """What was written.

    Attributes:
        path: of the machine's file.
        model: of the model that was written beside it; None where the given one will do.
        draft: what was guessed, and why.
    """

    path: Path
    model: Path | None
    draft: Draft

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        told = {k: v for k, v in asdict(self.draft).items() if k not in ("text", "model_text")}
        return {"plant": str(self.path), "model": str(self.model) if self.model else None, **told}


def new_machine(
    model: Path,
    logs: Sequence[Path],
    out: Path,
    rate: float | None = None,
    held: HeldFolder | None = None,
    scales: Mapping[str, float] | None = None,
) -> NewMachine:
    """Draft a machine's file and write it; of a URDF the model as MJCF beside it.

    Args:
        model: MJCF or URDF.
        logs: recordings of the machine; the first is matched, the others must fit.
        out: the file to write.
        rate: rows a second [Hz], where no column tells the time.
        held: the folder of `out`, where the caller holds it already.
        scales: constants that are known, as of a motor: column -> what one of its unit is.

    Raises:
        FileAccessError: a file that is missing, or one that a draft would be written over.
        InvalidInputError: files that cannot be read, or do not fit each other.
    """
    _refuse_existing(out)
    with hold_file(out) if held is None else nullcontext():
        found = draft(model, logs, out, rate, scales)
        beside = out.with_suffix(".xml") if found.model_text else None
        if beside is not None:
            _refuse_existing(beside)
            write_whole(beside, found.model_text)
        write_whole(out, found.text)
    return NewMachine(out, beside, found)


def _refuse_existing(path: Path) -> None:
    if path.exists():
        raise FileAccessError(f"{path} is there: a draft is never written over it, name another")
