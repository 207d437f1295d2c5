"""lawful_rows: rows of a motion in which laws act at the joints, stepped in compiled code."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray
from ves_twin.effects.law import Law, LawKind
from ves_twin.effects.law_kernel import CompiledLaws, law_efforts
from ves_twin.simulator.engine import address_of, call_engine, handles


def compiled_laws(laws: Sequence[Law], model: mujoco.MjModel) -> CompiledLaws:
    """Those of efforts among the laws, in a model that has their joints and actuators."""

    def variable(what: str, name: str) -> int:
        if what == "command":
            return int(model.actuator(name).id)
        joint = model.joint(name)
        return int(joint.qposadr[0] if what == "position" else joint.dofadr[0])

    acting = [law for law in laws if law.kind is LawKind.EFFORT]
    return CompiledLaws.of(acting, lambda name: int(model.joint(name).dofadr[0]), variable)


def push(laws: CompiledLaws, data: mujoco.MjData, own: FloatArray) -> None:
    """Put efforts into `own` (nv,) as they are now, and add them to what is applied."""
    law_efforts(
        float(data.time), data.qpos, data.qvel, data.ctrl, data.qfrc_smooth - own,
        laws, own,
    )  # fmt: skip
    data.qfrc_applied[:] += own


def lawful_rows(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    commands: FloatArray,
    steady: FloatArray,
    steps: int,
    laws: CompiledLaws,
) -> tuple[FloatArray, FloatArray]:
    """States (n, nq + nv) and sensors (n, all) under commands (n, nu) and laws.

    Args:
        model: whose physics.
        data: in its first state, at its time.
        commands: held over a row.
        steady: further efforts (nv,), the same all along.
        steps: of the model in a row.
        laws: that act at the joints.
    """
    path = np.zeros((len(commands), model.nq + model.nv))
    sensed = np.zeros((len(commands), model.nsensordata))
    _rows(
        address_of("mj_step"), *handles(model, data), steps, float(data.time),
        float(model.opt.timestep),
        np.ascontiguousarray(commands), steady, data.qpos, data.qvel, data.ctrl,
        data.qfrc_applied, data.qfrc_smooth, data.sensordata, laws,
        np.zeros(model.nv), path, sensed,
    )  # fmt: skip
    return path, sensed


@compiled
def _rows(
    mj_step: int, model: int, data: int, steps: int, begin: float, period: float,
    commands: FloatArray, steady: FloatArray, qpos: FloatArray, qvel: FloatArray,
    ctrl: FloatArray, applied: FloatArray, smooth: FloatArray, sensordata: FloatArray,
    laws: CompiledLaws, own: FloatArray, path: FloatArray, sensed: FloatArray,
) -> None:  # fmt: skip
    width = len(qpos)
    for k in range(len(commands)):
        path[k, :width] = qpos
        path[k, width:] = qvel
        ctrl[:] = commands[k]
        for n in range(steps):
            law_efforts(begin + (k * steps + n) * period, qpos, qvel, ctrl, smooth - own, laws, own)
            applied[:] = steady + own
            call_engine(mj_step, model, data)
            if n == 0:
                sensed[k] = sensordata
