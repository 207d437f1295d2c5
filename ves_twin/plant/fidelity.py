"""Fidelity: how much of the rig is modelled, and what the lesser one has no room for."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from ves_twin.core.errors import InvalidInputError


class Fidelity(StrEnum):
    """How much of the rig is modelled; the signals are the same.

    `full`: legs of two bodies that bend, closed chain, 39 degrees of freedom. `fast`: straight legs
    without bodies (spatial tendons), 9 degrees of freedom; a rod's mass is a point on the platform.
    """

    FULL = "full"
    FAST = "fast"

    @property
    def absent_signals(self) -> frozenset[str]:
        """Signals that a recording of this fidelity does not have."""
        return ABSENT_SIGNALS if self is Fidelity.FAST else frozenset()


ABSENT_SIGNALS = frozenset({"truth.leg_bending"})

ABSENT_PARAMETERS = frozenset(
    {
        "leg.bending_damping",
        "leg.bending_offset",
        "leg.bending_stiffness",
        "leg.cylinder_length",
        "leg.cylinder_mass",
        "leg.cylinder_radius",
        "leg.joint_damping",
        "leg.rod_length",
    }
)
"""Numbers that the fast rig has no room for: bending, cylinder bodies, friction of the joints."""


ABSENT_EFFECTS = frozenset({"leg_bending"})
"""Kinds of effects on parts that the fast rig does not have."""


def check_room(fidelity: Fidelity, changed: Iterable[str]) -> None:
    """Refuse parameters and effects that a fidelity has no room for, so that none is lost silently.

    Args:
        fidelity: how much is modelled.
        changed: names of parameters that differ from nominal, kinds of effects that it has.

    Raises:
        InvalidInputError: the fast rig with a parameter or an effect of a bending or massive leg;
            says which.
    """
    absent = ABSENT_PARAMETERS | ABSENT_EFFECTS
    lost = sorted(absent.intersection(changed)) if fidelity is Fidelity.FAST else []
    if lost:
        raise InvalidInputError(
            "fidelity",
            "fast",
            f"'full' for {', '.join(lost)}: straight legs without bodies have no room for it",
        )
