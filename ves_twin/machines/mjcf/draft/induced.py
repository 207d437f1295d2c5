"""induced, words_of_noise: what noise of a measured motion makes, once it is differentiated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.estimates import noise_of
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity

SPOILT = 0.5
"""Share of the power of what a model needs that a position's noise makes from which it is told: a
slope on it is too small by that share, a constant twice as large as it should be."""


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
    pull = differentiated(sd, log.period, band, differentiations(motion))
    actuator, joint = model.actuator(effort.spot.name), model.joint(motion.spot.name)
    gain = abs(float(actuator.gear[0] * actuator.gainprm[0])) or 1.0
    inertia = (felt or {}).get(motion.spot.name, model.dof_M0[int(joint.dofadr[0])])
    within = float(inertia) * pull / gain
    size = float(np.std(effort.factor * log.column(effort.column)))
    return within * np.sqrt(1.0 / (log.period * (rate or 2.0 * band))), within / size


def differentiated(sd: float, period: float, band: float, times: int) -> float:
    """Sd of white noise of rows a period apart, differentiated so often within a band [Hz]."""
    power = 2 * times + 1
    return float(sd * (2.0 * np.pi) ** times * np.sqrt(2.0 * period * band**power / power))


def words_of_noise(
    log: LogColumns,
    found: Sequence[Match],
    joint: str,
    need: FloatArray,
    inertia: float,
    band: float,
) -> str:
    """That noise of a joint's position is much of what the model needs there; empty if it is not.

    Args:
        log: the columns.
        found: what they are taken for.
        joint: of the effort.
        need: along the motion (m,), in the effort's unit.
        inertia: that makes it of an acceleration.
        band: of the motion [Hz].
    """
    for own in found:
        if own.spot.name == joint and own.spot.quantity is Quantity.POSITION:
            sd, _ = noise_of(*log.readings(own.column), None)
            made = inertia * differentiated(abs(own.factor) * sd, log.period, band, 2)
            share = (made / max(float(np.std(need)), 1e-300)) ** 2
            if share > SPOILT:
                what = f"noise of {own.column}, differentiated twice, is {min(share, 1.0):.0%}"
                return f"{what} of the power that the model needs"
    return ""


def differentiations(motion: Match) -> int:
    """How often a column is differentiated."""
    return 1 if motion.spot.quantity is Quantity.SPEED else 2


def with_motion(own: tuple[float, str], made: float) -> tuple[float, str]:
    """Noise of an effort with that which its joint's motion makes, and how it was told."""
    sd, how = own
    more = "; most of it is that of the motion, differentiated" if made > sd else ""
    return float(np.hypot(sd, made)), how + more
