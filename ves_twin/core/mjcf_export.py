"""MjcfExport: a machine as one plain MJCF file, and what such a file cannot carry."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill

from ves_twin.core.whole_file import write_whole

TOGETHER = (
    "Changes that were found together predict together: with a part of them it may predict worse."
    " ves-twin diagnose --no-law, or --exclude with their kinds, finds numbers that need none."
)
"""What is said where a file has a part of what was found."""


@dataclass(frozen=True)
class MjcfExport:
    """A machine as MJCF.

    Attributes:
        text: the file.
        carried: changes of the machine, by name, that the file has.
        lost: changes of the machine that are not written.
        never: what no file has, whatever the machine.
    """

    text: str
    carried: tuple[str, ...]
    lost: tuple[str, ...]
    never: tuple[str, ...]

    @staticmethod
    def of(
        title: str, body: str, carried: Sequence[str], lost: Sequence[str], never: Sequence[str]
    ) -> MjcfExport:
        """With a note at the head of the file that tells what is not in it."""
        lines = [title, "Not in this file:", *(f"- {what}" for what in (*lost, *never))]
        lines += [TOGETHER] if carried and lost else []
        note = "\n".join(fill(line, 96, subsequent_indent="  ") for line in lines)
        note = re.sub("-(?=-)", "- ", note)  # no comment of XML may hold two hyphens
        return MjcfExport(f"<!--\n{note}\n-->\n{body}", tuple(carried), tuple(lost), tuple(never))

    @property
    def note(self) -> str:
        """What to know where the file has a part alone of what was found; else empty."""
        return TOGETHER if self.carried and self.lost else ""

    def save(self, path: Path) -> None:
        """Write the file.

        Raises:
            FileAccessError: it cannot be written.
        """
        write_whole(path, self.text)
