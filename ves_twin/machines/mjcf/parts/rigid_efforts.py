"""RigidEfforts: inverse dynamics along one motion, for any masses, rotors and springs."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from threading import RLock

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.parts.inertials import inertials, set_inertials

STEP = 0.1
"""Departure of one of a body's numbers, in its own units, that a direction is computed with: no
round-off to speak of, as efforts are linear in it."""

ROUND_OFF = 1e-12
"""Departure, in the body's units, that counts as none."""

STIFFER = 10.0
"""Times the joints' inertia that each rotor has more of meanwhile: no joint may lack any."""

LARGEST = 2e8
"""Bytes that the directions of one motion may take; a longer one is computed model by model."""

_LINEAR = {
    int(getattr(mujoco.mjtSensor, f"mjSENS_{name}"))
    for name in (
        *("JOINTPOS", "JOINTVEL", "TENDONPOS", "TENDONVEL", "ACTUATORPOS", "ACTUATORVEL"),
        *("BALLQUAT", "BALLANGVEL", "FRAMEPOS", "FRAMEQUAT", "FRAMEXAXIS", "FRAMEYAXIS"),
        *("FRAMEZAXIS", "FRAMELINVEL", "FRAMEANGVEL", "FRAMELINACC", "FRAMEANGACC", "GYRO"),
        *("VELOCIMETER", "ACCELEROMETER", "MAGNETOMETER", "FORCE", "TORQUE", "CLOCK"),
        *("ACTUATORFRC", "JOINTACTFRC", "TENDONACTFRC"),
    )
}
"""Sensors whose reading along a given motion is linear in what bodies weigh, or independent."""

_TURNING = {int(mujoco.mjtObj.mjOBJ_BODY), int(mujoco.mjtObj.mjOBJ_CAMERA)}
"""What has a frame that follows the centre of mass: nothing there is linear."""

LIGHTEST, SHORTEST = 0.01, 0.1
"""Least unit of a body: share of the heaviest one's mass, and a distance [m]. A flange of a gram
that carries a payload would count it in millions of units, and their round-off."""


@dataclass(frozen=True)
class Moved:
    """Positions (n, nq), speeds and rigid-body efforts (n, nv), sensors (n, all) of a motion.

    Of its own model: whether a contact, limit or equality was at work.
    """

    position: FloatArray
    speed: FloatArray
    effort: FloatArray
    sensed: FloatArray
    bound: bool


Pass = Callable[[mujoco.MjModel, FloatArray, FloatArray, FloatArray], Moved]
"""Inverse dynamics of a model along qpos (n, nq), qvel and qacc (n, nv)."""


class RigidEfforts:
    """Efforts and sensors along a motion, linear in the inertial numbers phi of the bodies.

        tau(phi) = tau(phi_0) + sum_k (phi - phi_0)_k dtau / dphi_k

    Each direction of phi costs one pass of inverse dynamics, when a model first departs along it;
    what was asked before changes no bit. A rotor adds its inertia times the acceleration of its
    joint, a spring of a hinge or slide its stiffness times the way.

    Attributes:
        model: phi_0.
        speed, pull: of the motion (n, nv).
        linear: whether all this holds: no contact, limit or equality acts, there is no fluid, flex,
            plugin or clipped sensor, no sensor in a frame that follows a centre of mass, and the
            directions are not too large to be kept.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
        passed: Pass | None = None,
    ) -> None:
        self.model, self.speed, self.pull = copy.copy(model), v, a
        self._inverted = passed or inverted
        self._base = self._inverted(model, q, v, a)
        few = size_of(model, len(q)) <= LARGEST
        self.linear = not self._base.bound and is_linear(model) and few
        self._phi = inertials(model)
        self._unit = _units(self._phi)
        self._known: dict[tuple[int, int], tuple[FloatArray, FloatArray]] = {}
        self._lock = RLock()

    def of(self, model: mujoco.MjModel) -> Moved:
        """Efforts of a model that differs in masses, rotors and springs alone, where `linear`."""
        base = self._base
        departure = (inertials(model) - self._phi) / self._unit
        places = np.argwhere(np.abs(departure) > ROUND_OFF)
        effort, sensed = base.effort + self._of_joints(model), base.sensed.copy()
        for body, number in places.tolist():
            of_effort, of_sensor = self._direction(body, number)
            effort += departure[body, number] * of_effort
            sensed += departure[body, number] * of_sensor
        return replace(base, effort=effort, sensed=sensed)

    def _of_joints(self, model: mujoco.MjModel) -> FloatArray:
        """What other rotors and springs take (n, nv)."""
        effort = (model.dof_armature - self.model.dof_armature) * self.pull
        for number in np.flatnonzero(model.jnt_stiffness != self.model.jnt_stiffness):
            more = model.jnt_stiffness[number] - self.model.jnt_stiffness[number]
            at, dof = model.jnt_qposadr[number], model.jnt_dofadr[number]
            way = self._base.position[:, at] - model.qpos_spring[at]
            effort[:, dof] += more * way
        return np.asarray(effort)

    def _direction(self, body: int, number: int) -> tuple[FloatArray, FloatArray]:
        """Effort and sensor of one of a body's numbers, in its unit."""
        with self._lock:
            if (body, number) not in self._known:
                self._known[body, number] = self._passed(body, number)
            return self._known[body, number]

    def _passed(self, body: int, number: int) -> tuple[FloatArray, FloatArray]:
        """By one pass at a model that went there; a body without mass is given some first."""
        begin, effort, sensed = self._phi[body].copy(), self._base.effort, self._base.sensed
        if begin[0] == 0.0 and number:
            of_mass = self._direction(body, 0)
            begin[0] += self._unit[body, 0]
            effort, sensed = effort + of_mass[0], sensed + of_mass[1]
        begin[number] += STEP * self._unit[body, number]
        there = copy.copy(self.model)
        more = STIFFER * np.max(self.model.dof_M0)
        there.dof_armature[:] += more
        set_inertials(there, body, begin)
        moved = self._inverted(there, self._base.position, self.speed, self.pull)
        left = moved.effort - more * self.pull - effort
        return left / STEP, (moved.sensed - sensed) / STEP


def size_of(model: mujoco.MjModel, rows: int) -> int:
    """Bytes that all directions along a motion take."""
    return 80 * int(model.nbody) * rows * int(model.nv + model.nsensordata)


def _units(phi: FloatArray) -> FloatArray:
    """Of each body's numbers (bodies, 10): its mass, and the distance at which that turns so."""
    heaviest = float(np.max(phi[:, 0], initial=0.0)) or 1.0
    mass = np.maximum(phi[:, 0], LIGHTEST * heaviest)
    reach = np.maximum(np.sqrt(0.5 * phi[:, 4:7].sum(axis=1) / mass), SHORTEST)
    power = np.repeat([0.0, 1.0, 2.0], [1, 3, 6])
    return np.asarray(mass[:, None] * reach[:, None] ** power)


def is_linear(model: mujoco.MjModel) -> bool:
    """Whether nothing but constraints could make efforts and sensors bend."""
    discrete = model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_INVDISCRETE
    loose = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_SPRING
    fluid = model.opt.density or model.opt.viscosity
    turning = _TURNING & {*model.sensor_objtype, *model.sensor_reftype}
    told = set(model.sensor_type) <= _LINEAR and not np.any(model.sensor_cutoff) and not turning
    return told and not (discrete or loose or fluid or model.nflex or model.nplugin)


def inverted(model: mujoco.MjModel, q: FloatArray, v: FloatArray, a: FloatArray) -> Moved:
    """MuJoCo's inverse dynamics row by row."""
    data, bound = mujoco.MjData(model), False
    efforts, sensed = np.zeros((len(q), model.nv)), np.zeros((len(q), model.nsensordata))
    position, speed, pull = data.qpos, data.qvel, data.qacc
    effort, sensor, sensing = data.qfrc_inverse, data.sensordata, model.nsensordata > 0
    for k in range(len(q)):
        position[:], speed[:], pull[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        efforts[k] = effort
        bound = bound or data.nefc > 0
        if sensing:
            sensed[k] = sensor
    return Moved(q, v, efforts, sensed, bound)
