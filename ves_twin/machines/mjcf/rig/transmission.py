"""Transmission: which efforts at joints a few actuators give together, by joints and tendons."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.rig.places import tendon_joints

SINGULAR = 1e-9
"""Of the smallest singular value over the largest, below which efforts do not tell commands."""

EXPECTED = "as many compared actuators as joints that they act on, each on a joint or fixed tendon"


@dataclass(frozen=True)
class Transmission:
    """Actuators that act on the same joints: tau = arms u, of as many of one as of the other.

    A motor that stands on the base and pulls an elbow by a belt acts on shoulder and elbow alike:
    what the shoulder's own motor gives is what is left.

    Attributes:
        actuators: their names.
        joints: joints that any of them acts on.
    """

    actuators: tuple[str, ...]
    joints: tuple[str, ...]

    @staticmethod
    def of(model: mujoco.MjModel, actuator: str, others: Iterable[str]) -> Transmission:
        """Of an actuator, with those of the others that share a joint with it, on and on.

        Raises:
            InvalidInputError: more joints than actuators, two that give the same, or one that
                drives neither a joint nor a fixed tendon: its command is not told by the motion.
        """
        every = {name: arms_of(model, name) for name in dict.fromkeys((actuator, *others))}
        if not every[actuator]:
            raise InvalidInputError(f"actuator {actuator}, compared", "on a site or body", EXPECTED)
        names, joints = [actuator], set(every[actuator])
        while more := [n for n, arm in every.items() if n not in names and joints & set(arm)]:
            names += more
            joints = joints.union(*(every[n] for n in more))
        order = tuple(sorted(joints, key=lambda joint: int(model.joint(joint).id)))
        found = Transmission(tuple(names), order)
        if len(names) != len(order) or _singular(found.arms(model)):
            came = f"{' and '.join(names)} for {' and '.join(order)}"
            raise InvalidInputError(f"actuator {actuator}, compared", came, EXPECTED)
        return found

    def arms(self, model: mujoco.MjModel) -> FloatArray:
        """Effort at a joint for a command of 1, gear and gain included (joints, actuators)."""
        every = [arms_of(model, name) for name in self.actuators]
        return np.array([[one.get(joint, 0.0) for one in every] for joint in self.joints])

    def command(self, model: mujoco.MjModel, actuator: str, efforts: FloatArray) -> FloatArray:
        """Of one actuator (n,), from efforts at the joints (joints, n)."""
        at = self.actuators.index(actuator)
        return np.asarray(np.linalg.solve(self.arms(model), efforts)[at])


def told_by_motion(model: mujoco.MjModel, actuators: Iterable[str]) -> list[str]:
    """Those of some actuators whose own share of the efforts at their joints a motion tells.

    Two that push one joint are known by their sum alone.
    """
    names, found = list(actuators), []
    for name in names:
        try:
            Transmission.of(model, name, names)
        except InvalidInputError:
            continue
        found.append(name)
    return found


def _singular(arms: FloatArray) -> bool:
    """Whether different commands give the same efforts."""
    values = np.linalg.svd(arms, compute_uv=False)
    return bool(values[-1] <= SINGULAR * values[0])


def arms_of(model: mujoco.MjModel, actuator: str) -> dict[str, float]:
    """Joint -> effort there for a command of 1; empty for what drives neither joint nor tendon."""
    part = model.actuator(actuator)
    gain, at = float(part.gear[0]) * float(part.gainprm[0]), int(part.trnid[0])
    kind = int(part.trntype[0])
    if kind == int(mujoco.mjtTrn.mjTRN_JOINT):
        return {str(model.joint(at).name): gain}
    if kind == int(mujoco.mjtTrn.mjTRN_TENDON):
        return {name: share * gain for name, share in tendon_joints(model, model.tendon(at).name)}
    return {}
