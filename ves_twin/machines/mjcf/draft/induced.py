"""induced: noise that a measured motion makes in efforts, once it is differentiated."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity


def induced(
    motion: Match,
    noise: Mapping[str, tuple[float, str]],
    efforts: list[Match],
    model: mujoco.MjModel,
    log: LogColumns,
    band: float,
    rate: float = 0.0,
    felt: Mapping[str, float] | None = None,
) -> tuple[float, float]:
    """Noise that a motion makes in its joint's effort: of one row [SI], and as a share of it.

    Of one row: that which makes as much on the rows of the analysis, twice the band if no rate.

    White noise s of rows T apart, differentiated twice within a band f: s (2 pi)^2
    sqrt(2 T f^5 / 5); of a speed, once: s 2 pi sqrt(2 T f^3 / 3). The joint moves the inertia of
    its branch, or that which is `felt` there.
    """
    (effort,) = (m for m in efforts if m.spot.joint == motion.spot.name)
    sd, _ = noise[motion.column]
    times = differentiations(motion)
    power = 2 * times + 1
    pull = sd * (2.0 * np.pi) ** times * np.sqrt(2.0 * log.period * band**power / power)
    actuator, joint = model.actuator(effort.spot.name), model.joint(motion.spot.name)
    gain = abs(float(actuator.gear[0] * actuator.gainprm[0])) or 1.0
    inertia = (felt or {}).get(motion.spot.name, model.dof_M0[int(joint.dofadr[0])])
    within = float(inertia) * pull / gain
    size = float(np.std(effort.factor * log.column(effort.column)))
    return within * np.sqrt(1.0 / (log.period * (rate or 2.0 * band))), within / size


def differentiations(motion: Match) -> int:
    """How often a column is differentiated."""
    return 1 if motion.spot.quantity is Quantity.SPEED else 2


def with_motion(own: tuple[float, str], made: float) -> tuple[float, str]:
    """Noise of an effort with that which its joint's motion makes, and how it was told."""
    sd, how = own
    more = "; most of it is that of the motion, differentiated" if made > sd else ""
    return float(np.hypot(sd, made)), how + more
