"""ClockRate: a log whose clock runs fast or slow against the machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import Size

if TYPE_CHECKING:
    import mujoco

CLOCK = "clock"
"""The one target."""


@final
@dataclass(frozen=True)
class ClockRate(Effect):
    """The machine takes 1 + share of the time that the log tells: frames at another rate, a timer.

    A row of the log lasts p (1 + share) in the machine, with p the period of its clock. Of what is
    let go a scaled time is a scaled inertia beside its weight and springs, so that it stands for
    one, or one for it; a command or a measured effort tells them apart.
    """

    share: float = 0.0

    kind = "clock_rate"
    sizes = (Size("share", "1"),)
    anywhere = Anywhere(Element.LOG, 0.3, 5e-4, source="assumed: 24 frames a second told as 30")

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Stretch the step; a row has as many of them as before."""
        model.opt.timestep *= 1.0 + self.share
