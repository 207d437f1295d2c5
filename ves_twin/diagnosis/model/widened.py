"""Widened: a forward with commissioning tolerances as rigs in order show them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ves_twin.diagnosis.model.forward import Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper

STEP = 1.2
"""Ratio of the factors that tolerances are widened by, so that banks are used again."""

LEAST = 1.4
"""Factor below which the tolerances are taken as declared: five rigs tell them no better."""


@dataclass(frozen=True)
class Widened(ForwardWrapper):
    """The same plant, known less well: `factor` is on every commissioning sd."""

    factor: float

    @property
    def identity(self) -> str:
        """Of the forward and the factor."""
        return self.identified(f"widened {self.factor!r}")

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """With wider sd."""
        return tuple(replace(p, sd=self.factor * p.sd) for p in self.forward.parameters)


def widening(scale: float | None) -> float:
    """Factor of the second view: the scale on a ladder of STEP; 1 where it is not needed."""
    if scale is None or scale < LEAST:
        return 1.0
    return float(STEP ** np.round(np.log(scale) / np.log(STEP)))
