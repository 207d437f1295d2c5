"""ties_of: the joints of a rig that follow those whose motion is fed in."""

from __future__ import annotations

import mujoco

from ves_twin.machines.mjcf.parts.ties import Ties
from ves_twin.machines.mjcf.rig.description import Mode, RigDescription
from ves_twin.machines.mjcf.rig.transmission import arms_of


def ties_of(told: RigDescription, model: mujoco.MjModel) -> Ties:
    """Of a rig in the mode of its file; none where no motion is fed in."""
    drive = told.drive
    led = drive.joints if drive.mode is Mode.MOTION else drive.imposed
    compared = [one.actuator for one in told.compare.values() if one.actuator]
    pushed = {joint for name in compared for joint in arms_of(model, name)}
    return Ties.of(model, led, pushed, drive.locked) if led else Ties()
