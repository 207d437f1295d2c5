"""Reading: columns of a recording read in another way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class Reading:
    """Columns read in another way: factors and order of positions and efforts, gravity's sign.

    `less` has positions of which another one, times 1 or -1, is taken off, `zeros` what is added;
    `load` is a point mass and its place on a body [kg, m] (4,); `odd` where no usual unit has the
    factors.
    """

    name: str
    key: str
    positions: Mapping[str, float]
    efforts: Mapping[str, float]
    swapped: tuple[str, str] | None = None
    gravity: float = 1.0
    less: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    zeros: Mapping[str, float] = field(default_factory=dict)
    load: tuple[int, FloatArray] | None = None
    odd: bool = False

    @property
    def in_unit(self) -> bool:
        """Whether some column is read in another unit, which a mass that is off would fit, too."""
        return any(
            abs(abs(by) - 1.0) > 1e-9 for by in (*self.positions.values(), *self.efforts.values())
        )
