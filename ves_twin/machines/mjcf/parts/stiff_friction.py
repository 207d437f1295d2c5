"""stiff_friction: dry friction of a model that sticks, where its file says no softness."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.plant.assembly import FRICTION_SOLIMP

SOFT_SOLREF = (0.02, 1.0)
SOFT_SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)
"""The engine's defaults: a friction force turns round in 20 ms, and below its level it creeps."""


def stiff_friction(model: mujoco.MjModel) -> None:
    """Give joints and tendons with the engine's default softness two steps and impedance 0.9999.

    As the cylinders of VES II have it: with the defaults a mass m under a force F creeps at
    v = F (1 - d) / (d m b), d = 0.9, b = 2 / (0.95 * 20 ms). Where `solreffriction` or
    `solimpfriction` is another one it stays; without dry friction nothing changes.

    Source: docs/decisions/0008-dry-friction.md; MuJoCo's documentation, Solver parameters.
    """
    for solref, solimp in (
        (model.dof_solref, model.dof_solimp),
        (model.tendon_solref_fri, model.tendon_solimp_fri),
    ):
        soft = np.all(solref == SOFT_SOLREF, axis=1) & np.all(solimp == SOFT_SOLIMP, axis=1)
        solref[soft] = (2.0 * model.opt.timestep, 1.0)
        solimp[soft] = FRICTION_SOLIMP
