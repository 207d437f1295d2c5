"""LoopMotion: how all bodies of a machine whose chains close move with its drives."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.types import BoolArray, FloatArray, IntArray
from ves_twin.machines.mjcf.parts.loops import closed, dense_copy, followed, loop_rows

TURN = 0.3
"""Largest move [rad or m] of a part that nothing tells from one closed pose to the next: beyond it
a Newton step may end in the other pose in which two links meet."""

FAR = 20
"""Such moves from one row to the next beyond which a log is another motion, or in another unit."""

LOST = 0.1
"""Share of rows in which loops do not close beyond which no further row is tried."""

EPSILON = 1e-6
"""Time [s] over which a Jacobian's change is taken: central differences err by its square."""


@dataclass(frozen=True)
class LoopMotion:
    """All bodies along the motion of the drives, which leaves no other.

    With J the loops' Jacobian, d the drives and o all else,

        v = G v_d,  G_o = -J_o^+ J_d;   a_o = -J_o^+ (J_d a_d + dJ/dt v),

    and what drives must give for the efforts f of an open tree is G' f: loops do no work.

    Attributes:
        position: of all joints (m, nq).
        speed: of all degrees of freedom (m, nv).
        pull: their accelerations (m, nv).
        ways: G (m, nv, d).
        open: rows in which the loops do not close (m,): as the row before, at rest; all rows,
            where more than LOST of them do not.
    """

    position: FloatArray
    speed: FloatArray
    pull: FloatArray
    ways: FloatArray
    open: BoolArray

    @staticmethod
    def of(
        model: mujoco.MjModel,
        drives: IntArray,
        position: FloatArray,
        speed: FloatArray,
        pull: FloatArray,
    ) -> LoopMotion:
        """Close the loops about drives, from the model's home on.

        Args:
            model: of the machine.
            drives: their degrees of freedom (d,), each of a joint of its own.
            position: of the drives (m, d).
            speed: of the drives (m, d).
            pull: their accelerations (m, d).
        """
        follower = _Follower(model, drives)
        rows = len(position)
        q, v, a = np.zeros((rows, model.nq)), np.zeros((rows, model.nv)), np.zeros((rows, model.nv))
        ways = np.zeros((rows, model.nv, len(drives)))
        gone = np.zeros(rows, dtype=bool)
        for k in range(rows):
            if np.count_nonzero(gone) > LOST * rows:
                ways[:], v[:], a[:], gone[:] = 0.0, 0.0, 0.0, True
                q[k:] = follower.data.qpos
                break
            gone[k] = not follower.follow(position[k])
            q[k] = follower.data.qpos
            if not gone[k]:
                q[k, follower.places] = position[k]  # with its whole turns
                ways[k] = follower.ways
                v[k] = ways[k] @ speed[k]
                a[k] = follower.pull(v[k], pull[k])
        return LoopMotion(q, v, a, ways, gone)

    def at_drives(self, efforts: FloatArray) -> FloatArray:
        """What drives give (m, d) for efforts of an open tree (m, nv)."""
        return np.asarray(np.einsum("kvd,kv->kd", self.ways, efforts))


class _Follower:
    """A machine whose loops stay closed while its drives are moved."""

    def __init__(self, model: mujoco.MjModel, drives: IntArray) -> None:
        self.model = dense_copy(model)
        self.data = mujoco.MjData(self.model)
        self.drives = drives
        self.places = model.jnt_qposadr[model.dof_jntid[drives]]
        kinds = model.jnt_type[model.dof_jntid[drives]]
        self.hinges = kinds == int(mujoco.mjtJoint.mjJNT_HINGE)
        self.others = np.setdiff1d(np.arange(model.nv), drives)
        self._stands(loop_rows(self.model, self.data)[1])

    def follow(self, position: FloatArray) -> bool:
        """To a place of the drives (d,) in steps that links can follow; whether loops closed."""
        begun, start = self.data.qpos.copy(), self.data.qpos[self.places].copy()
        turns = np.round((position - start) / (2.0 * np.pi))
        position = position - 2.0 * np.pi * self.hinges * turns  # a wheel between two rows
        far = np.max(np.abs(self.ways @ (position - start)), initial=0.0)
        steps = max(int(np.ceil(far / TURN)), 1)
        if steps > FAR:
            return False
        for share in np.arange(1, steps + 1) / steps:
            now = start + share * (position - start)
            move = self.ways @ (now - self.data.qpos[self.places])
            mujoco.mj_integratePos(self.model, self.data.qpos, move, 1.0)
            self.data.qpos[self.places] = now
            rows = closed(self.model, self.data, self.others)
            if rows is None:
                self.data.qpos[:] = begun
                self._stands(loop_rows(self.model, self.data)[1])
                return False
            self._stands(rows)
        return True

    def pull(self, speed: FloatArray, driven: FloatArray) -> FloatArray:
        """Accelerations (nv,) at speeds (nv,), those of the drives (d,) given."""
        here = self.data.qpos.copy()
        mujoco.mj_integratePos(self.model, self.data.qpos, speed, EPSILON)
        ahead = loop_rows(self.model, self.data)[1]
        self.data.qpos[:] = here
        mujoco.mj_integratePos(self.model, self.data.qpos, speed, -EPSILON)
        behind = loop_rows(self.model, self.data)[1]
        self.data.qpos[:] = here
        bent = (ahead - behind) @ speed / (2.0 * EPSILON)
        found = np.zeros(self.model.nv)
        found[self.drives] = driven
        found[self.others] = -self.inverse @ (self.rows[:, self.drives] @ driven + bent)
        return found

    def _stands(self, rows: FloatArray) -> None:
        """With the loops' Jacobian (k, nv) there."""
        self.rows = rows
        self.ways, self.inverse = followed(rows, self.drives)
