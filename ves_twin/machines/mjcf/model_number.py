"""ModelNumber: an effect that adds to one number of the compiled model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from ves_twin.machines.mjcf.effect import RigEffect
from ves_twin.machines.mjcf.element import Element

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True)
class ModelNumber(RigEffect):
    """A concrete class says the array of the model; the target says the entry.

    Arrays by degree of freedom have the joint's first one, all others the element's own number.
    """

    array: ClassVar[str]

    def present(self, model: mujoco.MjModel) -> float:
        """The number, in the model."""
        return float(getattr(model, self.array)[self.entry(model)])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the number."""
        (change,) = self.sizes.values()
        getattr(model, self.array)[self.entry(model)] += change

    def entry(self, model: mujoco.MjModel) -> int | tuple[int, int]:
        """Where in the array."""
        if self.array.startswith("dof_"):
            return int(model.joint(self.target).dofadr[0])
        if self.element is Element.JOINT:
            return int(model.joint(self.target).id)
        if self.element is Element.TENDON:
            return int(model.tendon(self.target).id)
        if self.element is Element.ACTUATOR:
            return int(model.actuator(self.target).id)
        return int(model.body(self.target).id)
