"""BlindMachine: what makes measured recordings: another step, noise, rig than the model."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.diagnosis.model.grid import RATE
from ves_twin.suites.hidden_law import HiddenLaw
from ves_twin.suites.model_error import ModelError


@dataclass(frozen=True)
class BlindRig:
    """One rig that is measured.

    Attributes:
        values: parameter -> value, commissioning errors and hidden effects together.
        outside: kind of effect that the library lacks, or an edit that makes one of it; empty if
            none.
        size: of that.
        deployed: keys of the scenario that the rig's programs have otherwise than it says.
        background: further kinds that the library lacks, with their sizes.
        law: a function that no library has; None if none.
        errors: what its model gets wrong in single columns.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    outside: str = ""
    size: float = 0.0
    deployed: Mapping[str, object] = field(default_factory=dict)
    background: Mapping[str, float] = field(default_factory=dict)
    law: HiddenLaw | None = None
    errors: tuple[ModelError, ...] = ()

    def odd(self, kind: str) -> float:
        """Size of a kind that the library lacks; 0 if the rig has none of it."""
        return self.background.get(kind, 0.0) + (self.size if kind == self.outside else 0.0)


@dataclass(frozen=True)
class Edit:
    """A cause of the library as no class of effect makes it: by an edit of a model or a recording.

    Attributes:
        parameter: of the library, that departs by the size: "coulomb_friction@arm.q2:level".
        low, high: smallest and largest size.
    """

    parameter: str
    low: float
    high: float


class BlindMachine(ABC):
    """What a generator needs of a machine."""

    @property
    @abstractmethod
    def forward(self) -> Forward:
        """The model that a diagnosis will hold against the recordings."""

    @property
    @abstractmethod
    def outside(self) -> Mapping[str, tuple[float, float]]:
        """Kinds outside the library -> smallest and largest size."""

    @property
    def edits(self) -> Mapping[str, Edit]:
        """Causes of the library that an edit makes, by its name; none unless it says so."""
        return {}

    @property
    def errs(self) -> bool:
        """Whether its recordings can have `BlindRig.errors`; no unless it says so."""
        return False

    @property
    @abstractmethod
    def confusable(self) -> tuple[str, ...]:
        """Causes, effect@target, that the programme hardly tells from another one."""

    @property
    def rate(self) -> float:
        """Of the analysis grid [Hz]."""
        return RATE

    @property
    def excitations(self) -> Mapping[str, Excitation]:
        """What it can play next, by name; nothing unless it says so."""
        return {}

    @abstractmethod
    def record(
        self, rig: BlindRig, programme: str, rng: np.random.Generator, lead: float = 0.0
    ) -> Recording:
        """What the rig measures, nothing of the truth in it.

        Args:
            rig: the rig.
            programme: "train", "held_out", "poor" (it tells little) or "standstill".
            rng: of noise, disturbance and what else is drawn.
            lead: motion that comes before and is not recorded [s].

        Raises:
            InvalidInputError: a programme or a lead that this machine has not.
        """

    @abstractmethod
    def play(self, rig: BlindRig, programme: Excitation, rng: np.random.Generator) -> Recording:
        """What the rig measures while it is fed given set-points.

        Raises:
            InvalidInputError: a machine that plays none.
        """

    def commissioned(self, rng: np.random.Generator, spread: float = 1.0) -> dict[str, float]:
        """Values of a rig within its tolerances: nominal + spread * sd * normal."""
        return {
            p.name: float(np.clip(p.nominal + spread * p.sd * rng.standard_normal(), p.low, p.high))
            for p in self.forward.parameters
            if p.sd > 0.0
        }

    def again(
        self, values: Mapping[str, float], rng: np.random.Generator, spread: float, drift: float
    ) -> dict[str, float]:
        """Values of the same rig at another recording.

        Args:
            values: of the rig.
            rng: of what is drawn.
            spread: of what is drawn anew for each recording, in declared sd.
            drift: of what is not, in declared sd.
        """
        found = dict(values)
        for p in self.forward.parameters:
            if p.sd > 0.0 and (p.per_recording or drift > 0.0):
                mean = p.nominal if p.per_recording else found.get(p.name, p.nominal)
                step = (spread if p.per_recording else drift) * p.sd * rng.standard_normal()
                found[p.name] = float(np.clip(mean + step, p.low, p.high))
        return found
