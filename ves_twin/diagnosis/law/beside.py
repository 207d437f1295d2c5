"""Beside: a plant with causes at work, of which laws are looked for in what they leave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.model.forward import Excitation, Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace
from ves_twin.effects.law import Law


@dataclass(frozen=True)
class Beside(ForwardWrapper):
    """Sizes of causes are tolerances here, as wide as they are: a law may take all of a cause.

    Attributes:
        forward: the plant.
        sizes: parameters of the causes, nominal where they were fitted.
    """

    forward: LawForward
    sizes: tuple[Parameter, ...]

    @staticmethod
    def to(fit: Fit, forward: LawForward) -> Beside:
        """With the causes of a fit of the forward."""
        runs = fit.local.runs
        found = {}
        for cause in fit.causes:
            for i in runs.indices(cause):
                known, size = runs.coordinates[int(i)].parameter, float(fit.shift[i])
                found[known.name] = replace(known, nominal=known.nominal + size, sd=abs(size))
        return Beside(forward, tuple(found.values()))

    @property
    def identity(self) -> str:
        """Of the forward and the sizes."""
        return self.identified(f"beside {[(p.name, p.nominal, p.sd) for p in self.sizes]}")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Those of the plant, sizes of causes among the tolerances."""
        own = {p.name: p for p in self.sizes}
        return tuple(own.get(p.name, p) for p in self.forward.parameters)

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """See `LawForward`; with the causes where nothing else is said."""
        return self.forward.simulate(programme, self._with_causes(values), refined, laws)

    def law_places(self) -> tuple[LawPlace, ...]:
        """See `LawForward`."""
        return self.forward.law_places()

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """See `LawForward`."""
        return self.forward.visited(programme, self._with_causes(values), laws)

    @property
    def band(self) -> float:
        """See `Invertible`."""
        return self.forward.band

    def effort_unit(self, joint: str) -> str:
        """See `Invertible`."""
        return self.forward.effort_unit(joint)

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]] | None:
        """See `LawForward`."""
        known = self._with_causes(values)
        return self.forward.missing(programme, known, measured, as_nominal, laws)

    def _with_causes(self, values: Mapping[str, float]) -> dict[str, float]:
        return {p.name: p.nominal for p in self.sizes} | dict(values)
