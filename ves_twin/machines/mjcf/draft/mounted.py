"""mounted: gravity in a model that points otherwise than a log says, or is missing."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

STANDARD = 9.81
"""Of a model that has no gravity [m/s^2]."""

NONE = "none"

AXES = "xyz"


@dataclass(frozen=True)
class Mounted:
    """A machine under another gravity.

    Attributes:
        score: of the model with it.
        words: a sentence.
        numbers: gravity as a model's file has it [m/s^2].
        model: with it.
    """

    score: float
    words: str
    numbers: str
    model: mujoco.MjModel


def mounted(model: mujoco.MjModel, score: Callable[[mujoco.MjModel], float]) -> Mounted | None:
    """The gravity with which columns, as they are meant now, explain most, and words for it.

    An arm on a wall or a ceiling has the joints of one on a floor; signs and zeros that are turned
    in its place are false at every joint.

    Args:
        model: as it is.
        score: of a model, the larger the more it explains.

    Returns:
        The best; None where no gravity but the model's explains anything more.
    """
    off = bool(model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY))
    now = np.array(model.opt.gravity) * (not off)
    size = float(np.linalg.norm(now)) or STANDARD
    along = [sign * size * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
    other = [one for one in (*along, np.zeros(3)) if not np.allclose(one, now, atol=1e-3 * size)]
    other = [one + 0.0 for one in other]  # no -0
    found = [(score(_with_gravity(model, one)), n) for n, one in enumerate(other)]
    best, n = max(found)
    if best <= score(model):
        return None
    gravity = other[n]
    numbers = " ".join(f"{value:g}" for value in gravity)
    asked = "is the machine mounted so?"
    if not np.any(gravity):
        asked = "does it move level, or are the efforts compensated for weight?"
    words = (
        f"the numbers fit the model with gravity {_spoken(gravity)}, not {_spoken(now)}: {asked}"
        f' Then write <option gravity="{numbers}"/> into the model'
    )
    return Mounted(best, words, numbers, _with_gravity(model, gravity))


def _with_gravity(model: mujoco.MjModel, gravity: np.ndarray) -> mujoco.MjModel:
    other = copy.copy(model)
    other.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    other.opt.gravity[:] = gravity
    return other


def _spoken(gravity: np.ndarray) -> str:
    """Along an axis, none, or all three numbers."""
    axes = np.flatnonzero(gravity)
    if len(axes) == 0:
        return NONE
    if len(axes) > 1:
        return f"({', '.join(f'{value:.3g}' for value in gravity)})"
    return f"along {'+' if gravity[axes[0]] > 0.0 else '-'}{AXES[axes[0]]}"
