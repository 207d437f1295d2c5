"""Entry: one effect on one target of a machine's file, with the sizes that it may have there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.units import to_si
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.rig.description import Allowed, Setting


@dataclass(frozen=True)
class Entry:
    """One kind of effect on one target: sizes, nominal values, whether it is a cause.

    Attributes:
        effect: of that kind, with all sizes zero.
        place: its target.
        magnitudes: sizes with unit, range and commissioning sd.
        nominal: value of each, as the rig has it.
        cause: whether it may be named.
        per_recording: drawn anew for each recording.
        source: of the sizes.
        allowed: what the file says of it.
    """

    effect: Effect
    place: Place
    magnitudes: tuple[Magnitude, ...]
    nominal: tuple[float, ...]
    cause: bool
    per_recording: bool
    source: str
    allowed: Allowed

    @property
    def key(self) -> tuple[str, str]:
        """Kind and target."""
        return self.effect.kind, self.effect.target

    def name(self, magnitude: Magnitude) -> str:
        """Of a parameter: kind@target:magnitude."""
        return f"{self.effect.kind}@{self.effect.target}:{magnitude.name}"

    def at(self, values: Mapping[str, float]) -> Effect:
        """The effect where its parameters have values; those left out are nominal."""
        sizes = {}
        native = bool(self.effect.attribute)
        for magnitude, nominal in zip(self.magnitudes, self.nominal, strict=True):
            value = values.get(self.name(magnitude), nominal)
            sizes[magnitude.name] = value - nominal if native else value
        return self.effect.sized(sizes)

    def bounds(self, m: Magnitude, nominal: float, told: Setting | Allowed) -> tuple[float, float]:
        """Of a parameter: what the file says, else the largest departure; never what cannot be."""
        one_sided = m.sign is Sign.POSITIVE
        low, high = 0.0 if one_sided else nominal - m.largest, nominal + m.largest
        native = bool(self.effect.attribute)
        least = 0.0 if one_sided and native else self.effect.least(nominal)
        what = f"{self.effect.kind} of {self.effect.target}"
        if told.low is not None:
            low = to_si(told.low, m.unit, f"low of {what}")
        if told.high is not None:
            high = to_si(told.high, m.unit, f"high of {what}")
        if (told.low, told.high) != (None, None) and not low <= nominal <= high:
            raise InvalidInputError(f"low, high of {what}", (low, high), f"{nominal:g} within them")
        return min(max(low, least), nominal), high

    @staticmethod
    def told_of(m: Magnitude, first: Magnitude, allowed: Allowed) -> Allowed:
        """What the file says of a size: of a payload the mass, and nothing of its place.

        A component in another unit than the first size keeps its own range.
        """
        if m.unit == first.unit or not m.component:
            return allowed
        plain = {"sd": 0.0, **dict.fromkeys(("smallest", "largest", "low", "high"))}
        return allowed.model_copy(update=plain)

    @staticmethod
    def sized(
        m: Magnitude, allowed: Allowed, setting: Setting | None, what: str, own: float
    ) -> Magnitude:
        """A size with what the file says; all of a friction that the model has may be missing."""
        sd = to_si(setting.sd, m.unit, f"sd of {what}") if setting else 0.0
        sd = to_si(allowed.sd, m.unit, f"sd of {what}") or sd
        smallest, largest = m.smallest, m.largest
        if largest > 0.0 and m.sign is Sign.POSITIVE:
            largest = max(largest, own)
        if allowed.largest is not None:
            largest = to_si(allowed.largest, m.unit, f"largest of {what}")
            smallest = smallest * largest / m.largest
        if allowed.smallest is not None:
            smallest = to_si(allowed.smallest, m.unit, f"smallest of {what}")
        if not 0.0 < smallest < largest:
            expected = "0 < smallest < largest; typical sizes of its joint or signal give them"
            raise InvalidInputError(f"sizes of {what}", (smallest, largest), expected)
        return replace(m, sd=sd, smallest=smallest, largest=largest)
