"""bias_of: a constant effort at a joint as the bias of the actuator that drives it."""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree

import mujoco

from ves_twin.effects.effect import Effect
from ves_twin.effects.joints import ForceOffset
from ves_twin.machines.mjcf.rig.places import driven_joint

ON_STATE = (1, 2)
"""Numbers of a bias that hang on length and speed, beside the constant first one."""


@dataclass(frozen=True)
class ActuatorBias:
    """A constant b of an actuator's force, gain u + b.

    Attributes:
        actuator: its number.
        constant: what is added to b [N, N m at the actuator].
    """

    actuator: int
    constant: float

    def edit(self, model: mujoco.MjModel) -> None:
        """Add it to a model."""
        model.actuator_biastype[self.actuator] = mujoco.mjtBias.mjBIAS_AFFINE
        model.actuator_biasprm[self.actuator, 0] += self.constant


def bias_of(effect: Effect, model: mujoco.MjModel) -> ActuatorBias | None:
    """The bias that acts as an offset does; None of another effect, or where no motor is there.

    An offset o is what the drive must give: with a gear g, g b = -o.

    Args:
        effect: at work.
        model: of the machine.
    """
    if not isinstance(effect, ForceOffset):
        return None
    for i in range(model.nu):
        gear, bias = float(model.actuator_gear[i, 0]), int(model.actuator_biastype[i])
        plain = bias in (mujoco.mjtBias.mjBIAS_NONE, mujoco.mjtBias.mjBIAS_AFFINE)
        joint = model.joint(effect.target).id
        free = not (model.actuator_forcelimited[i] or model.jnt_actfrclimited[joint])
        if driven_joint(model, i) == effect.target and gear and plain and free:
            return ActuatorBias(i, -effect.offset / gear)
    return None


def write_biases(root: ElementTree.Element, model: mujoco.MjModel) -> None:
    """Let actuators of a file have the kind of bias that a model has: MuJoCo writes numbers alone.

    Args:
        root: of the file that MuJoCo wrote.
        model: with its biases.
    """
    section = root.find("actuator")
    for i, one in enumerate(section if section is not None else ()):
        constant = model.actuator_biasprm[i, 0] != 0.0
        if one.tag == "general" and constant and not one.get("biastype"):
            state = any(model.actuator_biasprm[i, n] for n in ON_STATE)
            if model.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_AFFINE and not state:
                one.set("biastype", "affine")
                one.set("biasprm", f"{model.actuator_biasprm[i, 0]:.6g} 0 0")
