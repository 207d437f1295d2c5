"""Layout: where the rig's quantities lie in MuJoCo's arrays; the only place with such indices."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.plant.assembly import JOINTS
from ves_twin.plant.parameters import LEGS


@dataclass(frozen=True)
class Layout:
    """Indices into the arrays of a compiled rig.

    A rod's travel is a joint coordinate in `full`, and the length of a tendon less its length at
    home in `fast`; `slide_at`, `speed_at` and `slide_home` are indices into the arrays that
    `slide_arrays` gives, and what to take off. The other fields are indices into qpos, qvel, ctrl,
    sensordata, sites and bodies.
    """

    slide_at: IntArray
    speed_at: IntArray
    slide_home: FloatArray
    tendons: bool
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

    @staticmethod
    def of(model: mujoco.MjModel) -> Layout:
        """The layout of a model compiled from `assemble`."""
        legs = range(1, LEGS + 1)
        arm = [model.joint(f"arm/{name}") for name in JOINTS]
        free = model.joint("platform/free")
        tendons = model.ntendon > 0
        slides = [] if tendons else [model.joint(f"leg{i}/slide") for i in legs]
        bends = [] if tendons else [f"leg{i}/bending_{axis}" for i in legs for axis in "xy"]
        universals = [] if tendons else [f"leg{i}/universal_{axis}" for i in legs for axis in "xy"]
        lines = [model.tendon(f"leg{i}").id for i in legs] if tendons else []
        return Layout(
            slide_at=_ints(lines or [j.qposadr[0] for j in slides]),
            speed_at=_ints(lines or [j.dofadr[0] for j in slides]),
            slide_home=model.tendon_lengthspring[lines, 0] if tendons else np.zeros(LEGS),
            tendons=tendons,
            universal_qpos=_ints([model.joint(name).qposadr[0] for name in universals]),
            bending_qpos=_ints([model.joint(name).qposadr[0] for name in bends]),
            platform_qpos=int(free.qposadr[0]),
            platform_dof=int(free.dofadr[0]),
            arm_qpos=_ints([j.qposadr[0] for j in arm]),
            arm_dof=_ints([j.dofadr[0] for j in arm]),
            leg_ctrl=_ints([model.actuator(f"leg{i}").id for i in legs]),
            arm_ctrl=_ints([model.actuator(name).id for name in JOINTS]),
            wrench_sensor=int(model.sensor("force").adr[0]),
            sensor_site=int(model.site("sensor/wrench").id),
            sensor_body=int(model.body("sensor/sensor").id),
        )

    @property
    def bends(self) -> int:
        """Number of bending coordinates."""
        return len(self.bending_qpos)

    def slide_arrays(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Live arrays that hold the rods' travel [m] and speed [m/s]."""
        if self.tendons:
            return data.ten_length, data.ten_velocity
        return data.qpos, data.qvel

    def slide(self, data: mujoco.MjData) -> FloatArray:
        """Rod travel from home [m] (6,); in `fast` that of the last forward computation."""
        return np.asarray(self.slide_arrays(data)[0][self.slide_at] - self.slide_home)


def _ints(values: list[int]) -> IntArray:
    return np.array(values, dtype=np.int64)
