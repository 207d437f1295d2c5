"""structural_modes: frequencies and damping of the rig with valves closed, by linearisation."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.plant.assembly import JOINTS, assemble, compile_model
from ves_twin.plant.fidelity import Fidelity
from ves_twin.plant.hydraulics import Hydraulics, chamber_stiffness, fill_chambers
from ves_twin.plant.layout import Layout
from ves_twin.plant.parameters import LEGS
from ves_twin.plant.physics import chambers
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig, static_leg_forces

SETTLE_SECONDS = 3.0
"""Time for the preload error of the placed rig to die out: ten time constants of the first mode."""

PERTURBATION = 1e-6
"""Step of the centred differences [m, rad]: far above round-off, far below any nonlinearity."""


@dataclass(frozen=True)
class Mode:
    """One mode of vibration.

    Attributes:
        frequency: undamped natural frequency [Hz].
        damping: damping ratio.
        bending_share: part of the potential energy of springs and oil that sits in leg bending.
    """

    frequency: float
    damping: float
    bending_share: float


def structural_modes(
    plant: Plant, pose: FloatArray, q: FloatArray, highest: float = 40.0
) -> list[Mode]:
    """Modes of platform, legs and payload at a pose, valves closed, arm held by its servo.

    The oil columns and the joint servos become joint springs and dampers, the rig settles, and
    MuJoCo's transition matrix about the rest gives the eigenvalues s = log(z) / h.

    Args:
        plant: the rig.
        pose: platform pose from home [m, rad] (6,).
        q: joint angles of the arm [rad] (3,).
        highest: leave out modes above this [Hz].

    Returns:
        Modes by rising frequency. The fast rig has none below its oil and its servos, since its
        legs do not bend.

    Source: thesis 5.2 (first modes 10 to 13 Hz, falling with leg extension).
    """
    tick = plant.actual.number("clock.tick")
    model, data = _resting(plant, tick, np.asarray(pose, float), np.asarray(q, float))
    size = 2 * model.nv + model.na
    transition = np.zeros((size, size))
    mujoco.mjd_transitionFD(model, data, PERTURBATION, True, transition, None, None, None)
    values, vectors = np.linalg.eig(transition)
    poles = np.log(values.astype(complex)) / tick
    bending = _bending_dofs(model)
    modes = []
    for pole, vector in zip(poles, vectors.T, strict=True):
        frequency = abs(pole) / (2 * np.pi)
        if pole.imag > 1.0 and frequency < highest:
            energy = _spring_energy(model, vector[: model.nv])
            share = float(np.sum(energy[bending]) / np.sum(energy)) if bending else 0.0
            modes.append(Mode(float(frequency), float(-pole.real / abs(pole)), share))
    return sorted(modes, key=lambda mode: mode.frequency)


def _resting(
    plant: Plant, tick: float, pose: FloatArray, q: FloatArray
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = assemble(plant, tick)
    array = plant.actual.array
    oil_stiffness, oil_damping = _oil(plant, pose)
    full = plant.fidelity is Fidelity.FULL
    for i in range(LEGS):
        rod = spec.joint(f"leg{i + 1}/slide") if full else spec.tendon(f"leg{i + 1}")
        rod.stiffness = np.array([oil_stiffness[i], 0.0, 0.0])
        rod.damping = np.array([oil_damping[i], 0.0, 0.0])
        rod.frictionloss = 0.0  # a leg that sticks would have no mode
    stiffness, damping = array("servo.stiffness"), array("servo.damping")
    for j, name in enumerate(JOINTS):
        joint = spec.joint(f"arm/{name}")
        joint.stiffness = np.array([stiffness[j], 0.0, 0.0])
        joint.damping = joint.damping + np.array([damping[j], 0.0, 0.0])
    model = compile_model(spec)
    data = mujoco.MjData(model)
    layout = Layout.of(model)
    place_rig(data, layout, plant.geometry, pose, q)
    force = static_leg_forces(model, data, layout, plant.geometry, pose)
    unloaded = layout.slide(data) + layout.slide_home + force / oil_stiffness
    if layout.tendons:
        model.tendon_lengthspring[layout.slide_at] = unloaded[:, None]
    else:
        model.qpos_spring[layout.slide_at] = unloaded
    sag = data.qfrc_bias[layout.arm_dof] / stiffness
    model.qpos_spring[layout.arm_qpos] = q + sag
    mujoco.mj_step(model, data, round(SETTLE_SECONDS / tick))
    return model, data


def _oil(plant: Plant, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness of each oil column (6,) [N/m] and its damping (6,) [N s/m], valves closed.

    In the pressure form the stiffness follows the rod travel, and the valves' null leakage, which
    damps in series with the oil, has no place in a joint: its damping ratios are too small.
    """
    array = plant.actual.array
    if plant.hydraulics is Hydraulics.LINEAR:
        return array("hydraulics.oil_stiffness"), array("hydraulics.oil_damping")
    block = np.zeros(1, chambers.PARAMETERS)
    fill_chambers(block[0], plant.actual)
    geometry = plant.geometry
    travel = geometry.lengths(pose) - geometry.lengths(np.zeros(6))
    return chamber_stiffness(block[0], travel), array("chamber.viscous")


def _bending_dofs(model: mujoco.MjModel) -> list[int]:
    if model.ntendon:
        return []
    return [
        int(model.joint(f"leg{i}/bending_{axis}").dofadr[0])
        for i in range(1, LEGS + 1)
        for axis in "xy"
    ]


def _spring_energy(model: mujoco.MjModel, shape: FloatArray) -> FloatArray:
    """Potential energy per degree of freedom of a mode shape, up to a common factor."""
    stiffness = np.zeros(model.nv)
    for j in range(model.njnt):
        if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE:
            stiffness[model.jnt_dofadr[j]] = np.ravel(model.jnt_stiffness[j])[0]
    return np.asarray(stiffness * np.abs(shape) ** 2)
