"""assemble and what it takes: bodies of a machine whose chains close."""

from __future__ import annotations

import copy

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray, IntArray

LOOPS = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
"""Equality constraints that close a chain of bodies."""

CLOSED = 1e-6
"""Gap of a loop [m or rad] that counts as none: soft constraints leave as much."""

STEPS = 20
"""Newton steps at most: a platform 5 mm from home takes three."""


def has_loops(model: mujoco.MjModel) -> bool:
    """Whether equality constraints tie bodies together."""
    return bool(np.any(np.isin(model.eq_type, LOOPS) & model.eq_active0.astype(bool)))


def loop_rows(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
    """Gaps (k,) and Jacobian (k, nv) of equality constraints where a machine stands.

    Args:
        model: with dense Jacobians.
        data: whose positions count.
    """
    mujoco.mj_fwdPosition(model, data)
    rows = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    return np.array(data.efc_pos[rows]), np.array(data.efc_J.reshape(-1, model.nv)[rows])


def freedom(model: mujoco.MjModel) -> int:
    """Motions that loops leave a machine at home: nv - rank J."""
    dense = dense_copy(model)
    _, rows = loop_rows(dense, mujoco.MjData(dense))
    return int(model.nv - np.linalg.matrix_rank(rows))


def followed(rows: FloatArray, drives: IntArray) -> tuple[FloatArray, FloatArray]:
    """How all else follows drives, from the Jacobian J (k, nv) of loops that leave no other motion.

    Returns:
        Speeds of all degrees of freedom for each drive's, G (nv, d) with G_o = -J_o^+ J_d; J_o^+.
    """
    others = np.setdiff1d(np.arange(rows.shape[1]), drives)
    inverse = np.asarray(np.linalg.pinv(rows[:, others]), dtype=float)
    ways = np.zeros((rows.shape[1], len(drives)))
    ways[drives] = np.eye(len(drives))
    ways[others] = -inverse @ rows[:, drives]
    return ways, inverse


def assemble(model: mujoco.MjModel, data: mujoco.MjData, known: IntArray) -> None:
    """Bring a machine with loops to where they close, in place and speed.

    Drives that stand 4 mm from the model's home would pull all else there in the first rows. With
    gaps g, Jacobian J and o the degrees of freedom that nothing tells,

        q_o -= J_o^+ g(q), until g is nothing;  v_o -= J_o^+ J v.

    Args:
        model: of the machine.
        data: its state; nothing happens without loops, or where they cannot close.
        known: degrees of freedom that are told.
    """
    if not has_loops(model):
        return
    dense = dense_copy(model)
    look = mujoco.MjData(dense)
    look.qpos[:] = data.qpos
    others = np.setdiff1d(np.arange(model.nv), known)
    rows = closed(dense, look, others)
    if rows is None:
        return
    data.qpos[:] = look.qpos
    data.qvel[others] -= np.linalg.pinv(rows[:, others]) @ (rows @ data.qvel)


def closed(dense: mujoco.MjModel, data: mujoco.MjData, others: IntArray) -> FloatArray | None:
    """Move degrees of freedom that nothing tells until loops close.

    Returns:
        The Jacobian (k, nv) where they close; None where they cannot.
    """
    for _ in range(STEPS):
        gaps, rows = loop_rows(dense, data)
        if np.max(np.abs(gaps), initial=0.0) < CLOSED:
            return rows
        move = np.zeros(dense.nv)
        move[others] = -np.linalg.pinv(rows[:, others]) @ gaps
        mujoco.mj_integratePos(dense, data.qpos, move, 1.0)
    return None


def dense_copy(model: mujoco.MjModel) -> mujoco.MjModel:
    """The model with dense Jacobians."""
    dense = copy.copy(model)
    dense.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    return dense
