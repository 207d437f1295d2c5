"""Limits: how much a lab file may unfold to, so that no small file fills the memory."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ves_twin.core.errors import InvalidInputError, UnknownNameError

RATIO = 50
"""Times its own size that a file may always unfold to: text of a lab packs 5 to 20 times, that of
a rig at rest 40 times."""

SIZES = {"B": 1, "KB": 10**3, "MB": 10**6, "GB": 10**9, "TB": 10**12}
_SIZE = re.compile(r"(\d{1,9}(?:\.\d{1,9})?)\s*([KMGT]?B)", re.IGNORECASE)


@dataclass(frozen=True)
class Limits:
    """Sizes [bytes] beyond which a file is refused.

    Attributes:
        unfolded: what a compressed file may hold, or the columns that are read of it; a file that
            is large itself may hold `RATIO` times its size.
        line: the longest line of a text table that is larger than the piece parsed at a time.
        message: the longest message of an MCAP file whose numbers are read; a quarter for JSON.
    """

    unfolded: int = 128 * 10**6
    line: int = 8 * 10**6
    message: int = 32 * 10**6

    @staticmethod
    def of(words: Sequence[str]) -> Limits:
        """Limits as a command gives them, for instance ["unfolded=2GB", "line=50MB"].

        Raises:
            UnknownNameError: no such limit.
            InvalidInputError: no size.
        """
        limits = Limits()
        for word in words:
            name, _, size = word.partition("=")
            if name not in vars(limits):
                raise UnknownNameError("limit", name, vars(limits))
            match = _SIZE.fullmatch(size.strip())
            if match is None:
                raise InvalidInputError(f"limit {name}", size, "a size, as in 500MB or 2GB")
            limits = replace(limits, **{name: int(float(match[1]) * SIZES[match[2].upper()])})
        return limits

    def most(self, path: Path) -> int:
        """Bytes that a file may unfold to."""
        return max(self.unfolded, RATIO * path.stat().st_size)

    def check_unfolded(self, path: Path, size: int) -> None:
        """Raise InvalidInputError if a file unfolds to more bytes than it may."""
        most = self.most(path)
        if size > most:
            raise _beyond(path, "unfolded", "what it unfolds to", most)

    def check_line(self, path: Path, size: int) -> None:
        """Raise InvalidInputError if a line is longer than it may be."""
        if size > self.line:
            raise _beyond(path, "line", "a line", self.line)

    def check_message(self, path: Path, size: int) -> None:
        """Raise InvalidInputError if a message is longer than it may be."""
        if size > self.message:
            raise _beyond(path, "message", "a message", self.message)


def _beyond(path: Path, name: str, what: str, most: int) -> InvalidInputError:
    came = f"more than {most / 1e6:.4g} MB"
    hint = f"inspect and import take more with --limit {name}={round(most / 1e5)}MB"
    return InvalidInputError(f"{path.name}: {what}", came, f"less; {hint}")
