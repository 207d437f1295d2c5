"""output_folder: where a command writes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path

from ves_twin.core.held_folder import HeldFolder, hold_folder


@contextmanager
def output_folder(given: str | None, name: str) -> Iterator[HeldFolder]:
    """The folder asked for, or the next free runs/NAME, runs/NAME-2, ..., held meanwhile.

    Raises:
        FileAccessError: it cannot be written, or another command writes it.
    """
    with ExitStack() as stack:
        if given is not None:
            yield stack.enter_context(hold_folder(Path(given)))
            return
        for number in count(1):
            folder = Path("runs") / (name if number == 1 else f"{name}-{number}")
            with suppress(FileExistsError):
                held = stack.enter_context(hold_folder(folder, new=True))
                break
        yield held
