"""Probe: a sensor that a model file does not have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

KINDS: Mapping[str, tuple[int, int, int]] = {
    "effort": (mujoco.mjtSensor.mjSENS_JOINTACTFRC, mujoco.mjtObj.mjOBJ_JOINT, 1),
    "force": (mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtObj.mjOBJ_SITE, 3),
    "acceleration": (mujoco.mjtSensor.mjSENS_ACCELEROMETER, mujoco.mjtObj.mjOBJ_SITE, 3),
}
"""What it measures -> MuJoCo's sensor, the element that has it, columns."""


@dataclass(frozen=True)
class Probe:
    """What the actuators give at a joint, or force or acceleration at a site.

    Attributes:
        kind: one of KINDS.
        element: the joint or site.
    """

    kind: str
    element: str

    @property
    def name(self) -> str:
        """Of the sensor."""
        return f"probe.{self.kind}.{self.element}"

    @property
    def width(self) -> int:
        """Columns."""
        return KINDS[self.kind][2]

    def add(self, spec: mujoco.MjSpec) -> None:
        """Add it to a model."""
        sort, element, _ = KINDS[self.kind]
        spec.add_sensor(name=self.name, type=sort, objtype=element, objname=self.element)
