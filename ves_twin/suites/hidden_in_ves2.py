"""hidden_effort, hidden_reading: a hidden law in a run of VES II, by other code than the twin's."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.simulator.simulator import Simulator
from ves_twin.suites.hidden_law import Acts, HiddenLaw


def hidden_effort(sim: Simulator, law: HiddenLaw) -> FloatArray:
    """Generalised forces (nv,) of a law at a joint of the arm, at a rod, or on the platform."""
    found = np.zeros(sim.model.nv)
    part, name = law.place.split(".")
    if part == "leg":
        _push_rod(sim, int(name) - 1, law, found)
    elif part == "arm":
        joint = sim.model.joint(f"arm/{name}")
        dof, at = int(joint.dofadr[0]), int(joint.qposadr[0])
        command = sim.data.ctrl[sim.model.actuator(name).id]
        found[dof] = _effort(law, sim.data.qpos[at], sim.data.qvel[dof], command)
    else:
        axis = ("x", "y", "z", "rx", "ry", "rz").index(name)
        dof, at = sim.rig.layout.platform_dof + axis, sim.rig.layout.platform_qpos + axis
        place = sim.data.qpos[at] - sim.plant.geometry.home[axis] if axis < 3 else 0.0
        found[dof] = _effort(law, place, sim.data.qvel[dof], 0.0)
    return found


def _effort(law: HiddenLaw, position: float, speed: float, command: float) -> float:
    x = {Acts.POSITION: position, Acts.SPEED: speed, Acts.COMMAND: command}[law.acts]
    return float(law.function(np.array([x]))[0])


def _push_rod(sim: Simulator, leg: int, law: HiddenLaw, found: FloatArray) -> None:
    """Along the line between a leg's joints, on the platform."""
    data, geometry = sim.data, sim.plant.geometry
    joint = data.site(f"platform/joint{leg + 1}").xpos
    line = joint - geometry.base[leg]
    length = float(np.linalg.norm(line))
    body = int(sim.model.body("platform/top").id)
    moves = np.zeros((3, sim.model.nv))
    mujoco.mj_jac(sim.model, data, moves, None, joint, body)
    speed = float(line @ moves @ data.qvel) / length
    home = float(geometry.lengths(np.zeros(6))[leg])
    current = float(sim.rig.state["current"][0, leg])
    found += moves.T @ (line / length) * _effort(law, length - home, speed, current)


def hidden_reading(
    law: HiddenLaw, signals: Mapping[str, FloatArray], truth: Mapping[str, FloatArray],
    time: FloatArray,
) -> None:  # fmt: skip
    """Change a column of what was recorded, in place.

    Args:
        law: of a reading; its `of` says of which joint's position or speed.
        signals: as they were recorded (n, width).
        truth: as they are (n, width).
        time: of the rows [s] (n,).
    """
    what, _, name = law.of.partition("@")
    joint = truth["truth.arm_q"][:, int(name.removeprefix("arm.q")) - 1]
    x = joint if what == "position" else np.gradient(joint, time)
    signal, _, column = law.place.rpartition(".")
    signals[signal][:, int(column) - 1] += law.function(x)
