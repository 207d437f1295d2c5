"""ForwardWrapper: a forward seen in another way; what a subclass leaves out is the forward's."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.directional import Directional, Moment, Visited
from ves_twin.diagnosis.model.forward import Channel, Excitation, Forward, Hypothesis, Parameter


@dataclass(frozen=True)
class ForwardWrapper:
    """Changes parameters, hypotheses or simulation of a plant without touching the plant.

    A subclass says its `identity`, by `identified`.

    Attributes:
        forward: the plant inside.
    """

    forward: Forward

    @property
    def drive(self) -> tuple[str, ...]:
        """See `Forward`."""
        return self.forward.drive

    @property
    def channels(self) -> tuple[Channel, ...]:
        """See `Forward`."""
        return self.forward.channels

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """See `Forward`."""
        return self.forward.parameters

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """See `Forward`."""
        return self.forward.hypotheses

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """See `Forward`."""
        return self.forward.simulate(programme, values, refined)

    def one_way_twins(
        self, labels: Sequence[str], moments: Sequence[Moment], visited: Visited | None = None
    ) -> Mapping[str, tuple[str, ...]]:
        """See `Directional`; none where the forward inside knows none."""
        inside = self.forward
        return (
            inside.one_way_twins(labels, moments, visited)
            if isinstance(inside, Directional)
            else {}
        )

    def identified(self, change: str, more: bytes = b"") -> str:
        """Identity of the forward with a change, for subclasses."""
        told = f"{self.forward.identity} {change}".encode()
        return hashlib.sha256(told + more).hexdigest()[:16]
