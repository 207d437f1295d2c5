"""BlindBench: a plant that makes measured recordings: another step, noise, rig than the model."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ves_twin.diagnosis.forward import Forward
from ves_twin.recording.recording import Recording


@dataclass(frozen=True)
class BlindRig:
    """One rig that is measured.

    Attributes:
        values: parameter -> value, commissioning errors and hidden effects together.
        outside: kind of effect that the library lacks; empty if none.
        size: of that.
        deployed: keys of the scenario that the rig's programs have otherwise than it says.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    outside: str = ""
    size: float = 0.0
    deployed: Mapping[str, object] = field(default_factory=dict)


class BlindBench(ABC):
    """What a generator needs of a plant."""

    @property
    @abstractmethod
    def forward(self) -> Forward:
        """The model that a diagnosis will hold against the recordings."""

    @property
    @abstractmethod
    def outside(self) -> Mapping[str, tuple[float, float]]:
        """Kinds outside the library -> smallest and largest size."""

    @property
    @abstractmethod
    def confusable(self) -> tuple[str, ...]:
        """Causes, effect@target, that the programme hardly tells from another one."""

    @abstractmethod
    def record(self, rig: BlindRig, programme: str, rng: np.random.Generator) -> Recording:
        """What the rig measures, nothing of the truth in it.

        Args:
            rig: the rig.
            programme: "train", "held_out" or "standstill".
            rng: of noise, disturbance and what else is drawn.
        """

    def commissioned(self, rng: np.random.Generator, spread: float = 1.0) -> dict[str, float]:
        """Values of a rig within its tolerances: nominal + spread * sd * normal."""
        return {
            p.name: float(np.clip(p.nominal + spread * p.sd * rng.standard_normal(), p.low, p.high))
            for p in self.forward.parameters
            if p.sd > 0.0
        }
