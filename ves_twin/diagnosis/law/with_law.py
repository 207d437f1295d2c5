"""WithLaw: a plant in which a candidate law is at work, its numbers among the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.model.law_forward import LawForward


@dataclass(frozen=True)
class WithLaw(ForwardWrapper):
    """A `Forward`: the numbers of laws are parameters of the plant, and each law is a cause.

    Attributes:
        forward: the plant.
        candidates: laws with open numbers; none is the plant itself.
    """

    forward: LawForward
    candidates: tuple[Candidate, ...] = ()

    @property
    def identity(self) -> str:
        """See `Forward`."""
        return " with ".join([self.forward.identity, *(one.label for one in self.candidates)])

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Of the plant, and the numbers of the laws."""
        own = (p for one in self.candidates for p in one.parameters)
        return (*self.forward.parameters, *own)

    def __post_init__(self) -> None:
        names = [p.name for p in self.parameters]
        if len(set(names)) < len(names):
            raise InvalidInputError("laws", [c.label for c in self.candidates], "other labels each")

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """The laws."""
        return tuple(one.hypothesis for one in self.candidates)

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """See `Forward`."""
        laws = [
            one.law(np.array([values.get(p.name, p.nominal) for p in one.parameters]))
            for one in self.candidates
        ]
        return self.forward.simulate(programme, self.of_plant(values), refined, laws)

    def of_plant(self, values: Mapping[str, float]) -> dict[str, float]:
        """Those of a set of values that are the plant's."""
        own = {p.name for one in self.candidates for p in one.parameters}
        return {name: value for name, value in values.items() if name not in own}
