"""MEASURED, REFERENCE, BEFORE, AFTER: one colour for each role, on every page and in every viewer.

They stay apart for the colour-blind, on white and on black.
Source: M. Okabe and K. Ito, Color Universal Design, 2008.
"""

from __future__ import annotations

Colour = tuple[int, int, int]
"""Red, green, blue, 0 to 255."""

MEASURED = "#0072b2"
"""What was measured or, on the rig, what it did: blue."""

REFERENCE = "#cc79a7"
"""What it is held against beside a model: true zero gravity, another recording; purple."""

BEFORE = "#d55e00"
"""The model as it is: vermilion."""

TOLERANCES = "#e69f00"
"""The model with its tolerances fitted and no cause: orange."""

AFTER = "#009e73"
"""The model with the cause: green."""

RESIDUAL = "#444b52"
"""A difference that is alone in its plot: grey."""

ENVELOPE = "#dde2e7"
"""The band in which a machine in order may lie, or in which noise alone does: pale grey."""

LIMIT = "#a32020"
"""A line that marks a limit: dark red."""


def rgb(name: str) -> Colour:
    """A colour of this file as numbers."""
    return int(name[1:3], 16), int(name[3:5], 16), int(name[5:7], 16)
