"""Effects of the admittance computer: model mass, age of the gravity estimate.

They show while the loop is closed over the force sensor. A replay drives the legs with recorded
set-points, and the estimate is recorded, too: it cannot see them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Magnitude, Sign

_COMPUTERS = ("computers",)


@final
@dataclass(frozen=True)
class ModelMass(Effect):
    """Phi and Gamma are those of another mass: M -> (1 + share) M in the deployed model.

    The whole matrix, inertia and coupling with it; the zero-g reference keeps the system that the
    scenario names, so that the emulation error shows it.
    """

    share: float = 0.0

    kind: ClassVar[str] = "model_mass"
    targets: ClassVar[tuple[str, ...]] = _COMPUTERS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("share", "1", 0.0, 0.05, 0.5),)
    channels: ClassVar[tuple[str, ...]] = ("platform.command", "leg.length")
    source: ClassVar[str] = "thesis eqs 2.4 to 2.6, errata E-2: matrices worked out beforehand"

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Scale the mass matrix.

        Raises:
            InvalidInputError: nothing is emulated.
        """
        if "emulated.mass" not in numbers:
            raise InvalidInputError("effects.model_mass", self.share, "an emulated system")
        numbers["emulated.mass"] *= 1.0 + self.share


@final
@dataclass(frozen=True)
class StaleGravity(Effect):
    """The gravity estimate is older than planned by whole cycles, the nearest to `cycles`."""

    cycles: float = 0.0

    kind: ClassVar[str] = "stale_gravity"
    targets: ClassVar[tuple[str, ...]] = _COMPUTERS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("cycles", "1", 0.0, 1.0, 20.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("gravity.estimate", "platform.command")
    source: ClassVar[str] = "thesis 2.4.2: the estimate comes through shared memory"

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Let the estimate grow older."""
        numbers["gravity.age"] += np.rint(self.cycles)
