"""Widened: a forward with commissioning tolerances as rigs in order show them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Channel, Excitation, Forward, Hypothesis, Parameter

STEP = 1.2
"""Ratio of the factors that tolerances are widened by, so that banks are used again."""

LEAST = 1.4
"""Factor below which the tolerances are taken as declared: five rigs tell them no better."""


@dataclass(frozen=True)
class Widened:
    """The same plant, known less well.

    Attributes:
        forward: with the tolerances as declared.
        factor: on every commissioning sd.
    """

    forward: Forward
    factor: float

    @property
    def identity(self) -> str:
        """Of the forward and the factor."""
        told = f"{self.forward.identity} widened {self.factor!r}"
        return hashlib.sha256(told.encode()).hexdigest()[:16]

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Those of the forward."""
        return self.forward.channels

    @property
    def drive(self) -> tuple[str, ...]:
        """That of the forward."""
        return self.forward.drive

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """With wider sd."""
        return tuple(replace(p, sd=self.factor * p.sd) for p in self.forward.parameters)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Those of the forward."""
        return self.forward.hypotheses

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """As the forward."""
        return self.forward.simulate(programme, values, refined)


def widening(scale: float | None) -> float:
    """Factor of the second view: the scale on a ladder of STEP; 1 where it is not needed."""
    if scale is None or scale < LEAST:
        return 1.0
    return float(STEP ** np.round(np.log(scale) / np.log(STEP)))
