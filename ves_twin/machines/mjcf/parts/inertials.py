"""inertials: what inverse dynamics is linear in: masses, first moments, inertias of bodies."""

from __future__ import annotations

import copy

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray

_UPPER = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))
"""Places of xx, yy, zz, xy, xz, yz in a matrix."""

_OF_BODIES = ("body_mass", "body_ipos", "body_iquat", "body_inertia")

_FOLLOWING = (
    *("body_subtreemass", "body_sameframe", "body_invweight0", "dof_invweight0", "dof_M0"),
    *("tendon_invweight0", "actuator_acc0", "cam_poscom0", "light_poscom0"),
    *("dof_length", "bvh_aabb", "geom_sameframe", "site_sameframe"),
)
"""What MuJoCo derives from them in `mj_setConst`."""


def inertials(model: mujoco.MjModel) -> FloatArray:
    """Of each body m, m c (3) and its inertia about its frame (6): (bodies, 10) [kg, m].

    With these the efforts along a motion are linear: tau = Y(q, v, a) phi.

    Source: Atkeson, An, Hollerbach 1986, Estimation of inertial parameters of manipulator loads and
    links, International Journal of Robotics Research 5(3).
    """
    mass, centre = np.asarray(model.body_mass), np.asarray(model.body_ipos)
    axes = np.empty((model.nbody, 9))
    for row, turn in zip(axes, model.body_iquat, strict=True):
        mujoco.mju_quat2Mat(row, turn)
    turned = axes.reshape(-1, 3, 3)
    about = np.einsum("bij,bj,bkj->bik", turned, model.body_inertia, turned)
    about += mass[:, None, None] * _steiner(centre)
    return np.column_stack([mass, mass[:, None] * centre, about[:, _UPPER[0], _UPPER[1]]])


def set_inertials(model: mujoco.MjModel, body: int, numbers: FloatArray) -> None:
    """Give a body of a model these numbers (10,); no mass leaves its centre in its origin.

    What MuJoCo derives from them follows: some joints take their inertia from there.
    """
    mass, about = float(numbers[0]), np.empty((3, 3))
    about[_UPPER] = about[_UPPER[::-1]] = numbers[4:]
    centre = numbers[1:4] / mass if mass else np.zeros(3)
    about -= mass * _steiner(centre[None])[0]
    inertia, axes = np.diag(about), np.eye(3)
    if np.any(about != np.diag(inertia)):
        inertia, axes = np.linalg.eigh(about)
        axes[:, 0] *= np.sign(np.linalg.det(axes))
    mujoco.mju_mat2Quat(model.body_iquat[body], axes.ravel())
    model.body_mass[body], model.body_ipos[body], model.body_inertia[body] = mass, centre, inertia
    mujoco.mj_setConst(model, mujoco.MjData(model))


def point_mass(mass: float, at: FloatArray) -> FloatArray:
    """The numbers (10,) of a mass [kg] at a place of a body's frame [m] (3,)."""
    about = mass * _steiner(at[None])[0]
    return np.concatenate([[mass], mass * at, about[_UPPER]])


def with_inertials_of(model: mujoco.MjModel, other: mujoco.MjModel) -> mujoco.MjModel:
    """A model with another one's masses, inertias, rotors, and springs of hinges and slides."""
    found = copy.copy(model)
    for name in (*_OF_BODIES, *_FOLLOWING, "dof_armature"):
        getattr(found, name)[:] = getattr(other, name)
    single = found.jnt_type >= int(mujoco.mjtJoint.mjJNT_SLIDE)  # or a hinge
    found.jnt_stiffness[single] = other.jnt_stiffness[single]
    found.stat.meaninertia, found.stat.meanmass = other.stat.meaninertia, other.stat.meanmass
    return found


def _steiner(centre: FloatArray) -> FloatArray:
    """What a mass of one at each centre (n, 3) adds to the inertia about the origin (n, 3, 3)."""
    squares = np.einsum("ni,ni->n", centre, centre)[:, None, None] * np.eye(3)
    return np.asarray(squares - centre[:, :, None] * centre[:, None, :])
