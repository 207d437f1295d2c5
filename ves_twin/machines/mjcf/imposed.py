"""Imposed: joints that move as recorded, or stand, while all others are integrated."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.machines.mjcf.inverse import efforts_along, smoothed
from ves_twin.machines.mjcf.places import driven_joint
from ves_twin.machines.mjcf.work import Work

HEAVY = 1e6
"""Inertia of an imposed joint, in the largest of the model: its acceleration is a millionth off
what is asked, which the next step, set anew to the recorded place and speed, does not remember."""


@dataclass(frozen=True)
class Imposed:
    """Motion of imposed joints at every step of a simulation.

    Such a joint gets an inertia I beside which all efforts of the machine are nothing, and the
    effort I a of its recorded acceleration a: MuJoCo's own step then gives the others what the
    imposed ones do to them, with constraints and friction as they are. The effort that imposed
    joints need is that of inverse dynamics along the motion that comes of it.

    Attributes:
        work: with the model as it is.
        places, dofs: addresses of the imposed coordinates in qpos and qvel.
        position, speed, pull: of them at each step (steps, k).
        inertia: that they get.
    """

    work: Work
    places: IntArray
    dofs: IntArray
    position: FloatArray
    speed: FloatArray
    pull: FloatArray
    inertia: float

    @staticmethod
    def of(work: Work, steps: int) -> Imposed:
        """Of one prediction, `steps` to a row; makes the imposed joints of its model heavy.

        Recorded positions are low-passed without phase; a cubic spline tells speeds and
        accelerations.
        """
        model, programme, drive = work.model, work.programme, work.rig.description.drive
        rows = len(programme.time)
        at = np.arange(rows * steps) / steps
        places, dofs, motions = [], [], []
        for joint, signal in drive.imposed_signals.items():
            column = work.position(joint, programme.drive[signal][:, 0])
            smooth = smoothed(column, programme.period, drive.smoothing)
            spline, rate = CubicSpline(np.arange(rows), smooth), 1.0 / programme.period
            motions.append([rate**k * spline(at, k) for k in range(3)])
            places.append(int(model.joint(joint).qposadr[0]))
            dofs.append(int(model.joint(joint).dofadr[0]))
        joints = [model.joint(joint).id for joint in drive.locked]
        still = np.flatnonzero(np.isin(model.dof_jntid, joints))
        stands = np.concatenate([_coordinates(model, joint) for joint in joints] or [still])
        position, speed, pull = np.array(motions).reshape(-1, 3, len(at)).transpose(1, 2, 0)
        none = np.zeros((len(at), len(still)))
        inertia = HEAVY * max(float(np.max(model.dof_M0, initial=0.0)), 1e-9)
        plain = replace(work, model=copy.copy(model))
        heavy = np.concatenate([dofs, still]).astype(np.int64)
        model.dof_armature[heavy] = inertia
        return Imposed(
            plain,
            np.concatenate([places, stands]).astype(np.int64),
            heavy,
            np.hstack([position, np.tile(model.qpos0[stands], (len(at), 1))]),
            np.hstack([speed, none]),
            np.hstack([pull, none]),
            inertia,
        )

    def move(self, data: mujoco.MjData, step: int) -> None:
        """Set place and speed of a step, and the effort that keeps the recorded acceleration."""
        if not len(self.dofs):
            return
        data.qpos[self.places] = self.position[step]
        data.qvel[self.dofs] = self.speed[step]
        data.qfrc_applied[self.dofs] = self.inertia * self.pull[step]

    def commands(self, path: FloatArray, pull: FloatArray) -> dict[str, FloatArray]:
        """What the actuators of imposed joints give (n,), where they are compared.

        Args:
            path: qpos and qvel of the rows (n, nq + nv).
            pull: accelerations (n, nv).
        """
        told, model = self.work.rig.description, self.work.model
        compared = (c.actuator for c in told.compare.values() if c.actuator)
        names = [n for n in compared if driven_joint(model, n) in told.drive.imposed]
        if not names:
            return {}
        return efforts_along(self.work, names, path[:, : model.nq], path[:, model.nq :], pull)


def _coordinates(model: mujoco.MjModel, joint: int) -> IntArray:
    """Addresses of a joint in qpos."""
    ends = np.append(model.jnt_qposadr, model.nq)
    return np.arange(ends[joint], ends[joint + 1])
