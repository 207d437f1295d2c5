"""WithFilterPlaces: VES II whose leg program may filter another signal than its scenario says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.effects.law import Law
from ves_twin.machines.ves2.forward import RigForward

EFFECT = "filter_place"
"""The cause; its target is the place where the filter is deployed."""

SOURCE = "thesis 5.3, 5.4: the section was on the error first, then on the measured length"


@dataclass(frozen=True)
class WithFilterPlaces(ForwardWrapper):
    """A filter at another place has no size of its own, so it gets one: f0 + s (f1 - f0).

    f0 is the rig with the filter where the scenario has it, f1 with the filter at another place. A
    program that was deployed so has s = 1; an interval that leaves 1 out says that it is not this.

    Attributes:
        forward: the rig under the scenario as it is written.
    """

    forward: RigForward

    @cached_property
    def identity(self) -> str:
        """That of the rig, and the places."""
        return self.identified(f"{sorted(self.places)}")

    @property
    def places(self) -> tuple[FilterPlace, ...]:
        """Where else the filter could be."""
        here = self.forward.scenario.legs.filter
        return tuple(place for place in FilterPlace if place is not here)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Those of the rig, and one share for each place."""
        shares = (Parameter(_name(place), "1", 0.0, 0.0, 1.5) for place in self.places)
        return (*self.forward.parameters, *shares)

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Those of the rig, and one for each place."""
        other = (
            Hypothesis(EFFECT, place.value, (_name(place),), (0.4,), (1.25,), (1,), SOURCE, True)
            for place in self.places
        )
        return (*self.forward.hypotheses, *other)

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """Channels (n, channels) that a rig with these values and laws measures, without noise."""
        own = _of_the_rig(values)
        rows = self.forward.simulate(programme, own, refined, laws)
        found = rows
        for place, rig in self._others.items():
            share = values.get(_name(place), 0.0)
            if share != 0.0:
                # an edge is a number of a filter, and there is none
                kept = {n: v for n, v in own.items() if place is not FilterPlace.NONE or _known(n)}
                found = found + share * (rig.simulate(programme, kept, refined, laws) - rows)
        return np.asarray(found)

    def law_places(self) -> tuple[LawPlace, ...]:
        """Those of the rig."""
        return self.forward.law_places()

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """Variables of the rig with the filter where the scenario has it."""
        return self.forward.visited(programme, _of_the_rig(values), laws)

    @property
    def band(self) -> float:
        """As the rig."""
        return self.forward.band

    def effort_unit(self, joint: str) -> str:
        """As the rig."""
        return self.forward.effort_unit(joint)

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> None:
        """As the rig."""
        self.forward.missing(programme, _of_the_rig(values), measured, as_nominal, laws)

    @cached_property
    def _others(self) -> dict[FilterPlace, RigForward]:
        scenario = self.forward.scenario
        return {
            place: replace(
                self.forward,
                scenario=scenario.model_copy(
                    update={"legs": scenario.legs.model_copy(update={"filter": place})}
                ),
            )
            for place in self.places
        }


def _of_the_rig(values: Mapping[str, float]) -> dict[str, float]:
    return {name: v for name, v in values.items() if not name.startswith(f"{EFFECT}@")}


def _name(place: FilterPlace) -> str:
    return f"{EFFECT}@{place.value}:share"


def _known(name: str) -> bool:
    return not name.startswith("filter_edge@")
