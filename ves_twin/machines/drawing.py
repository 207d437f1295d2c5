"""Drawing: a machine as bodies, and where they are when its channels read something."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import mujoco

from ves_twin.core.types import FloatArray

Columns = Mapping[str, FloatArray]
"""Signal -> rows (n, width)."""


@dataclass(frozen=True)
class Drawing:
    """What is drawn, by kinematics alone.

    Attributes:
        model: compiled.
        needs: signal that places it -> columns of it; without all of them it cannot be drawn.
        place: their rows -> joint coordinates qpos (n, nq).
    """

    model: mujoco.MjModel
    needs: Mapping[str, int]
    place: Callable[[Columns], FloatArray]
