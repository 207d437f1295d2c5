"""closed_chain: the inertia that each drive of a parallel machine feels, where drives tell all."""

from __future__ import annotations

from collections.abc import Collection

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.motion import Motion
from ves_twin.machines.mjcf.parts.loop_motion import LOST
from ves_twin.machines.mjcf.parts.loops import dense_copy, followed, has_loops, loop_rows

OPEN = 0.02
"""Share of rows in which loops may stay open untold: a noisy row beside the end of a reach."""


def closed_chain(model: mujoco.MjModel, driven: Collection[str]) -> dict[str, float]:
    """Driven joints of a machine whose loops leave no other motion -> inertia there [kg or kg m^2].

    With C the loops' Jacobian at home, d driven and o other degrees of freedom, all motion follows
    from the drives if C_o has full column rank: v = G v_d, G_o = -C_o^+ C_d. A drive feels the
    diagonal of G' M G.

    Args:
        model: of the machine.
        driven: joints with a motor.

    Returns:
        Nothing of a machine without loops, or with motion that its drives do not tell.
    """
    if not driven or not has_loops(model):
        return {}
    dense = dense_copy(model)
    data = mujoco.MjData(dense)
    _, rows = loop_rows(dense, data)
    of_drives = np.array([int(dense.joint(name).dofadr[0]) for name in driven])
    others = np.setdiff1d(np.arange(dense.nv), of_drives)
    if np.linalg.matrix_rank(rows[:, others]) < len(others):
        return {}
    ways, _ = followed(rows, of_drives)
    mass = np.zeros((dense.nv, dense.nv))
    mujoco.mj_fullM(dense, data, mass)
    felt = np.diag(ways.T @ mass @ ways)
    return {name: float(inertia) for name, inertia in zip(driven, felt, strict=True)}


def words_of_open(motion: Motion) -> list[str]:
    """That loops of the model do not close along a motion of its drives; none where they do."""
    if motion.open < OPEN:
        return []
    rows = f"{motion.open:.0%}" if motion.open < 1.0 else f"over {LOST:.0%}"
    return [
        f"signs are not checked: in {rows} of the rows the loops of the model do not close: look at"
        " lengths of its links, and at zeros, units and signs of the drives' positions"
    ]
