"""Errors: one base class; every message says what came, what was expected and the nearest match."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MOST_NAMES = 50
"""Names that a message lists; more would fill the terminal."""


class VesTwinError(Exception):
    """Base of every error that a user can cause; its text is one clear line."""

    def __reduce__(self) -> tuple[object, ...]:
        """As type and text, so that an error of another process arrives as what it is."""
        return _rebuilt, (type(self), str(self))


class VesTwinWarning(UserWarning):
    """What a user should know although nothing failed; its text is one clear line."""


def _rebuilt(kind: type[VesTwinError], text: str) -> VesTwinError:
    error = kind.__new__(kind)
    Exception.__init__(error, text)
    return error


class UnknownNameError(VesTwinError):
    """A name that does not exist, answered with the nearest one that does.

    Args:
        kind: what was looked for, for instance "scenario".
        name: what came.
        known: what exists.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        names = sorted(known)
        name = name if len(name) < 80 else f"{name[:77]}..."
        bare = {one.lstrip("-"): one for one in names}  # two dashes alone are no likeness
        near = difflib.get_close_matches(name.lstrip("-"), bare, n=1, cutoff=0.5)
        told = [*names[:MOST_NAMES], f"and {len(names) - MOST_NAMES} more"]
        listed = ", ".join(told if len(names) > MOST_NAMES else names) or "none"
        hint = f"did you mean '{bare[near[0]]}'?" if near else f"known: {listed}"
        super().__init__(f"unknown {kind} '{name}'; {hint}")


class InvalidInputError(VesTwinError):
    """A value of the wrong kind, unit, shape or range."""

    def __init__(self, what: str, came: object, expected: str) -> None:
        super().__init__(f"{what}: got {shown(came)}, expected {expected}")


class UnreachableError(VesTwinError):
    """A pose or length outside the workspace."""


class VersionError(VesTwinError):
    """A file written by another version of the format."""

    def __init__(self, path: object, found: object, expected: int) -> None:
        super().__init__(
            f"{path}: schema version {shown(found)} is not the one this program reads ({expected})"
        )


class FileAccessError(VesTwinError):
    """A file or folder that is missing, unreadable or read-only."""


class PluginError(VesTwinError):
    """An installed extension that cannot be used: a clash of names, or it does not load."""


class EndedEarlyError(VesTwinError):
    """A run that was needed to its end left the rig's limits, or diverged."""


class ControllerError(VesTwinError):
    """A controller that raised or returned something that is not a finite command."""


def shown(value: object, width: int = 160) -> str:
    """A value as a message shows it: its repr, cut where it would fill the terminal."""
    text = repr(value)
    return text if len(text) <= width else f"{text[: width - 3]}..."


def one_line(error: BaseException) -> str:
    """The message of an error folded to one line, for the terminal."""
    return " ".join(str(error).split()) or type(error).__name__
