"""without_progress: what a command told on stderr, less the lines that a slow machine adds."""

import re

PROGRESS = re.compile(r"compiling the inner loop|.*, [^,]+ so far\b")
"""A line of `ves_twin.cli.progress`: they come after a second, so that clocks decide."""


def without_progress(text: str) -> str:
    return "".join(line for line in text.splitlines(True) if not PROGRESS.match(line))
