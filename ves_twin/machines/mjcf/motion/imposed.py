"""Imposed: joints that move as recorded, or stand, while all others are integrated."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.machines.mjcf.motion.inverse import efforts_along
from ves_twin.machines.mjcf.motion.smoothed import smoothed
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.parts.loops import assemble
from ves_twin.machines.mjcf.rig.places import driven_joint

HEAVY = 1e6
"""Inertia of an imposed joint, in the largest of the model: its acceleration is a millionth off
what is asked, which the next step, set anew to the recorded place and speed, does not remember."""

STAGED = mujoco.mjtIntegrator.mjINT_RK4
"""Integrator with several looks at a step, of which the last one is left behind in the data."""


@dataclass(frozen=True)
class Imposed:
    """Motion of imposed joints at every step of a simulation.

    Such a joint gets an inertia I beside which all efforts of the machine are nothing, and the
    effort I a of its recorded acceleration a: MuJoCo's own step then gives the others what the
    imposed ones do to them, with constraints and friction as they are. The effort that imposed
    joints need is that of inverse dynamics along the motion that comes of it.

    An acceleration is held over a step. Euler's and the implicit integrators have speeds between
    the steps, so that it is the one at the step's begin; that of Runge and Kutta has them at the
    steps, and it is the one in the middle, else all efforts are late by half a step.

    Attributes:
        work: with the model as it is.
        places, dofs: addresses of the imposed coordinates in qpos and qvel.
        position, speed: of them at each step (steps, k).
        pull: acceleration that is held from there on (steps, k).
        begun: acceleration at each step (steps, k).
        inertia: that they get.
    """

    work: Work
    places: IntArray
    dofs: IntArray
    position: FloatArray
    speed: FloatArray
    pull: FloatArray
    begun: FloatArray
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
        late = 0.5 / steps if model.opt.integrator == STAGED else 0.0
        places, dofs, motions = [], [], []
        for joint, signal in drive.imposed_signals.items():
            column = work.position(joint, work.seen(signal)[:, 0])
            smooth = smoothed(column, programme.period, drive.smoothing)
            spline, rate = CubicSpline(np.arange(rows), smooth), 1.0 / work.period
            motion = [rate**k * spline(at, k) for k in range(3)]
            motions.append([*motion, rate**2 * spline(at + late, 2)])
            places.append(int(model.joint(joint).qposadr[0]))
            dofs.append(int(model.joint(joint).dofadr[0]))
        joints = [model.joint(joint).id for joint in drive.locked]
        still = np.flatnonzero(np.isin(model.dof_jntid, joints))
        stands = np.concatenate([_coordinates(model, joint) for joint in joints] or [still])
        position, speed, begun, pull = np.array(motions).reshape(-1, 4, len(at)).transpose(1, 2, 0)
        none = np.zeros((len(at), len(still)))
        inertia = HEAVY * max(float(np.max(model.dof_M0, initial=0.0)), 1e-9)
        plain = replace(work, model=copy.copy(model))
        heavy = np.concatenate([dofs, still]).astype(np.int64)
        model.dof_armature[heavy] = inertia
        model.dof_M0[heavy] += inertia  # of a lone part MuJoCo takes its inertia from there
        return Imposed(
            plain,
            np.concatenate([places, stands]).astype(np.int64),
            heavy,
            np.hstack([position, np.tile(model.qpos0[stands], (len(at), 1))]),
            np.hstack([speed, none]),
            np.hstack([pull, none]),
            np.hstack([begun, none]),
            inertia,
        )

    def begin(self, data: mujoco.MjData, step: int) -> None:
        """At the recorded place and speed, the bodies of loops where these close."""
        if len(self.dofs):
            self.move(data, step)
            assemble(self.work.model, data, self.dofs)

    def move(self, data: mujoco.MjData, step: int) -> None:
        """Set place and speed of a step."""
        data.qpos[self.places] = self.position[step]
        data.qvel[self.dofs] = self.speed[step]

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
