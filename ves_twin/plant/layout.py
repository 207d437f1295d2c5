"""Layout: where the rig's quantities lie in MuJoCo's arrays; the only place with such indices."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.plant.assembly import JOINTS
from ves_twin.plant.parameters import LEGS
from ves_twin.types import IntArray


@dataclass(frozen=True)
class Layout:
    """Indices into qpos, qvel, ctrl and sensordata of a compiled rig."""

    slide_qpos: IntArray
    slide_dof: IntArray
    universal_qpos: IntArray
    bending_qpos: IntArray
    platform_qpos: int
    platform_dof: int
    arm_qpos: IntArray
    arm_dof: IntArray
    leg_ctrl: IntArray
    arm_ctrl: IntArray
    wrench_sensor: int
    sensor_site: int
    sensor_body: int
    top_site: int

    @staticmethod
    def of(model: mujoco.MjModel) -> Layout:
        """The layout of a model compiled from `assemble`."""
        legs = range(1, LEGS + 1)
        slides = [model.joint(f"leg{i}/slide") for i in legs]
        bends = [model.joint(f"leg{i}/bending_{axis}") for i in legs for axis in "xy"]
        universals = [model.joint(f"leg{i}/universal_{axis}") for i in legs for axis in "xy"]
        arm = [model.joint(f"arm/{name}") for name in JOINTS]
        free = model.joint("platform/free")
        return Layout(
            slide_qpos=_ints([j.qposadr[0] for j in slides]),
            slide_dof=_ints([j.dofadr[0] for j in slides]),
            universal_qpos=_ints([j.qposadr[0] for j in universals]),
            bending_qpos=_ints([j.qposadr[0] for j in bends]),
            platform_qpos=int(free.qposadr[0]),
            platform_dof=int(free.dofadr[0]),
            arm_qpos=_ints([j.qposadr[0] for j in arm]),
            arm_dof=_ints([j.dofadr[0] for j in arm]),
            leg_ctrl=_ints([model.actuator(f"leg{i}").id for i in legs]),
            arm_ctrl=_ints([model.actuator(name).id for name in JOINTS]),
            wrench_sensor=int(model.sensor("force").adr[0]),
            sensor_site=int(model.site("sensor/wrench").id),
            sensor_body=int(model.body("sensor/sensor").id),
            top_site=int(model.site("platform/top").id),
        )


def _ints(values: list[int]) -> IntArray:
    return np.array(values, dtype=np.int64)
