"""Rubbing: a dry friction whose size depends on where the joint stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Curve
from ves_twin.diagnosis.law.forms import SHARP
from ves_twin.diagnosis.law.result import RUBS
from ves_twin.diagnosis.law.screen import KNOTS
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.effects.law import Law, LawKind, LawShape


@dataclass(frozen=True)
class Rubbing(Curve):
    """sign(v) g(q), g the curve, q the position and v the speed of a joint.

    A belt that is tighter at one end, a rail with a dent, a screw that binds once a turn.

    Attributes:
        fastest: ends of the speed in the recordings [m/s or rad/s], below and above zero.
    """

    fastest: tuple[float, float]

    def law(self, numbers: FloatArray) -> Law:
        """A mesh, whose rows of speed are -g, -g, g, g."""
        low, high = self.fastest
        sharp = SHARP * (high - low)
        names = tuple(v.name for v in self.of)
        values = tuple(np.outer(numbers, (-1.0, -1.0, 1.0, 1.0)).ravel().tolist())
        knots = (self.knots, (low, -sharp, sharp, high))
        return Law(self.place.name, self.place.kind, LawShape.MESH, names, knots, values, RUBS)


def rubbings(places: Sequence[LawPlace], ends: Mapping[str, tuple[float, float]]) -> list[Rubbing]:
    """One at every joint that was seen to move both ways.

    Args:
        places: where a law may act.
        ends: of every variable in the recordings.
    """
    found: list[Rubbing] = []
    for place in places:
        own = {v.what: v for v in reversed(place.variables) if v.name in ends}
        if place.kind is not LawKind.EFFORT or not {"position", "speed"} <= own.keys():
            continue
        (low, high), fastest = (ends[own[what].name] for what in ("position", "speed"))
        sharp = SHARP * (fastest[1] - fastest[0])
        if high > low and fastest[0] < -sharp and fastest[1] > sharp:
            knots = tuple(np.linspace(low, high, KNOTS["position"]).tolist())
            found.append(Rubbing(place, (own["position"], own["speed"]), knots, fastest))
    return found
