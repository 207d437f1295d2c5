"""Colours: a fixed colour per axis, leg and joint, distinct also to the colour-blind."""

from __future__ import annotations

from ves_twin.report.colours import REFERENCE, Colour, rgb

_CYCLE: tuple[Colour, ...] = (
    (230, 120, 60),
    (80, 165, 235),
    (75, 185, 125),
    (235, 195, 70),
    (195, 125, 195),
    (160, 160, 160),
)

GHOST = (*rgb(REFERENCE), 70)
"""Colour and opacity of the zero-g reference in the 3-D view."""

BACKGROUND: Colour = (78, 88, 101)
"""Between the light and the dark theme, and darker than the arm."""


def axis_colours(count: int) -> tuple[Colour, ...]:
    """Colours of the lines of one entity; twelve lines are six pairs of a strong and a pale one."""
    if count <= len(_CYCLE):
        return _CYCLE[:count]
    pairs = [shade for colour in _CYCLE for shade in (colour, pale(colour))]
    return tuple(pairs[i % len(pairs)] for i in range(count))


def pale(colour: Colour) -> Colour:
    """A lighter, greyer shade of a colour."""
    red, green, blue = ((c + 210) // 2 for c in colour)
    return red, green, blue
