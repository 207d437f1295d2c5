"""RigSet: a distribution of rigs in a file: effects with their odds, commissioning errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.refusal import refusal
from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.effects.effect import Effect
from ves_twin.effects.registry import kind_on_ves2, targets_of
from ves_twin.plant.plant import NOMINAL, Plant
from ves_twin.scenario.fields import Part

SCHEMA = 1

CUT = 3.0
"""Normal sizes are drawn anew beyond so many sd, so that a rig stays a rig."""


class Size(Part):
    """How one magnitude is drawn, in its unit: evenly between bounds, or normally about zero."""

    low: float | None = None
    high: float | None = None
    sd: Annotated[float, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        even = self.low is not None and self.high is not None and self.low <= self.high
        if even == (self.sd is not None) or (self.low is None) != (self.high is None):
            raise ValueError("give low and high, or sd")
        return self

    def draw(self, rng: np.random.Generator) -> float:
        """A size."""
        if self.low is not None and self.high is not None:
            return float(rng.uniform(self.low, self.high))
        value = float(rng.standard_normal())
        while abs(value) > CUT:
            value = float(rng.standard_normal())
        return value * float(self.sd or 0.0)


class DrawnEffect(Part):
    """One kind of effect: on which targets, on what share of them, how large."""

    kind: str
    targets: tuple[str, ...] | None = None
    share: Annotated[float, Field(gt=0, le=1)] = 1.0
    sizes: dict[str, Size]

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        try:
            kind = kind_on_ves2(self.kind)
        except UnknownNameError as error:
            raise ValueError(str(error)) from None
        names = [size.name for size in kind.sizes]
        for name in self.sizes:
            if name not in names:
                raise ValueError(str(UnknownNameError(f"magnitude of {self.kind}", name, names)))
        for target in self.targets or ():
            if target not in kind.targets:
                what = f"target of {self.kind}"
                raise ValueError(str(UnknownNameError(what, target, kind.targets)))
        if set(names) != set(self.sizes):
            raise ValueError(f"sizes of {self.kind}: expected {', '.join(names)}")
        return self

    def draw(self, rng: np.random.Generator) -> list[Effect]:
        """Effects on some of the targets, sizes held within the kind's own bounds."""
        kind, found = kind_on_ves2(self.kind), []
        for target in self.targets or targets_of(self.kind):
            if rng.uniform() < self.share:
                bounds = {m.name: (m.low, m.high) for m in kind.magnitudes_of(target)}
                sizes = {n: float(np.clip(s.draw(rng), *bounds[n])) for n, s in self.sizes.items()}
                found.append(kind(target, **sizes))
        return found


class _File(Part):
    schema_: Annotated[int, Field(alias="schema")]
    source: str
    effects: tuple[DrawnEffect, ...] = ()
    commissioning: dict[str, Annotated[float, Field(gt=0)]] = Field(default_factory=dict)
    times: dict[str, Annotated[float, Field(gt=0)]] = Field(default_factory=dict)


@dataclass(frozen=True)
class RigSet:
    """Rigs that differ from a plant by drawn effects and by what commissioning left open.

    Attributes:
        name: of the file.
        effects: what may be wrong.
        commissioning: parameter -> how many of its declared sd it is off, one sigma.
        times: parameter -> factor of all of its values in every rig of the set.
        source: where the sizes come from.
    """

    name: str
    effects: tuple[DrawnEffect, ...]
    commissioning: dict[str, float]
    times: dict[str, float]
    source: str

    @staticmethod
    def load(name_or_path: str) -> RigSet:
        """A set from models/rig_sets/ ("train-v0"), or from a file.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: no such set, key, effect, target, magnitude or parameter.
            InvalidInputError: sizes that are none.
            VersionError: another version of the format.
        """
        path = find_resource("set of rigs", "models/rig_sets", name_or_path)
        content, _ = read_toml("set of rigs", path)
        check_schema(content, path, SCHEMA)
        try:
            file = _File.model_validate(content)
        except ValidationError as error:
            raise refusal(error, path.name, _File) from None
        known = Plant.load(NOMINAL).parameters
        for name in (*file.commissioning, *file.times):
            if name not in known:
                raise UnknownNameError(f"parameter in {path.name}", name, known)
        return RigSet(path.stem, file.effects, file.commissioning, file.times, file.source)

    def draw(self, plant: Plant, rng: np.random.Generator) -> Plant:
        """One rig: a plant with drawn effects and drawn parameters.

        Raises:
            InvalidInputError: a plant that has no room for what was drawn.
        """
        plant = commissioned(plant, self.commissioning, rng)
        array = plant.parameters.array
        plant = plant.with_values({k: (f * array(k)).tolist() for k, f in self.times.items()})
        return plant.extended(*(e for drawn in self.effects for e in drawn.draw(rng)))


def commissioned(plant: Plant, sigmas: dict[str, float], rng: np.random.Generator) -> Plant:
    """A plant whose parameters are off by a share of the sd that its table declares.

    Args:
        plant: the plant, whose values the belief keeps.
        sigmas: parameter -> standard deviations, one sigma of the draw.
        rng: draws them, cut at three sigma.

    Raises:
        UnknownNameError: no such parameter.
        InvalidInputError: a parameter that is declared exact.
    """
    values = {}
    for name, sigma in sigmas.items():
        entry = plant.parameters[name]
        if not np.any(entry.sd > 0):
            raise InvalidInputError(f"commissioning.{name}", "sd = 0", "a parameter with an sd")
        off = np.clip(rng.standard_normal(entry.value.shape), -CUT, CUT) * sigma * entry.sd
        values[name] = np.clip(entry.value + off, entry.low, entry.high).tolist()
    return plant.with_values(values)
