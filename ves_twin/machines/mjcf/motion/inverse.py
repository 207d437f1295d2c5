"""efforts_of_motion: what actuators and sensors must show where the joints move as recorded."""

from __future__ import annotations

import copy
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.law import LawKind
from ves_twin.effects.shifted import shifted
from ves_twin.machines.mjcf.motion.kept_efforts import KeptEfforts
from ves_twin.machines.mjcf.motion.smoothed import smoothed
from ves_twin.machines.mjcf.motion.thinned import Thinned
from ves_twin.machines.mjcf.motion.work import Work, measured_variables, sensor_rows, variables
from ves_twin.machines.mjcf.parts.inertials import with_inertials_of
from ves_twin.machines.mjcf.parts.rigid_efforts import Moved, RigidEfforts, inverted, size_of
from ves_twin.machines.mjcf.parts.ties import Ties
from ves_twin.machines.mjcf.rig.transmission import Transmission

PICKED = 20
"""Rounds after which drives that pick up a half of each other's command are known to 1e-6."""

KEPT = 24
"""Models along a motion whose efforts are kept: few causes change them."""

RECORDED = 1024
"""Recorded motions that are kept: as many as anybody fits together."""


def efforts_of_motion(work: Work) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Signals (n, w) that the rig's description compares and that motion determines.

    Positions are low-passed without phase and differentiated by central differences; MuJoCo's
    inverse dynamics gives the effort at each joint, with springs and gravity. Damping is added,
    and dry friction with a smoothed sign. Rows that are poses at rest have no speed.

    Returns:
        Signals, and the variables that laws depend on (n,).
    """
    told, model = work.rig.description, work.model
    moved = _moved_of(work)
    found, asked = {}, [one.actuator for one in told.compare.values() if one.actuator]
    commands = needed_commands(work, asked, moved)
    for name, compared in told.compare.items():
        if compared.actuator:
            found[name] = compared.sign * commands[compared.actuator][:, None]
        elif compared.sensor:
            found[name] = compared.sign * sensor_rows(model, moved.sensed, compared)
    path = np.hstack([moved.position, moved.speed])
    return found, variables(model, work.programme.time, path)


def efforts_along(
    work: Work,
    actuators: Sequence[str],
    position: FloatArray,
    speed: FloatArray,
    pull: FloatArray,
) -> dict[str, FloatArray]:
    """The command (n,) that each actuator needs along qpos (n, nq), qvel and qacc (n, nv)."""
    return needed_commands(work, actuators, moved_along(work, position, speed, pull))


def moved_along(work: Work, position: FloatArray, speed: FloatArray, pull: FloatArray) -> Moved:
    """Rigid-body efforts along qpos (n, nq), qvel and qacc (n, nv)."""
    return inverted(_rigid(work.model, work.ties), position, speed, pull)


def _rigid(model: mujoco.MjModel, ties: Ties) -> mujoco.MjModel:
    """A copy without what is added to its rigid-body efforts, or acts through a command."""
    return _bared(copy.copy(model), ties)


def _bared(model: mujoco.MjModel, ties: Ties) -> mujoco.MjModel:
    """The same of the model itself."""
    ties.free(model)
    model.dof_frictionloss[:] = 0.0
    model.dof_damping[:] = 0.0
    model.tendon_frictionloss[:] = 0.0
    model.tendon_damping[:] = 0.0
    model.actuator_gainprm[:] = 0.0
    return model


def _content(model: mujoco.MjModel) -> bytes:
    """Every number of a model: an effect of another package may have edited any."""
    content = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, content)
    return content.tobytes()


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@dataclass(frozen=True)
class _Path:
    """Where joints are; equal to another one if its hash is."""

    key: str
    work: Work = field(compare=False)
    positions: Mapping[str, FloatArray] = field(compare=False)


@dataclass(frozen=True)
class _Motion:
    """A path of a model; equal to another one if it is, and the model's numbers are."""

    path: _Path
    numbers: str
    recorded: bool
    model: mujoco.MjModel = field(compare=False)

    def states(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `_states`."""
        return _kept_states(self.path) if self.recorded else _states(self.path)

    @property
    def thinned(self) -> Thinned:
        """Rows that efforts are computed at; poses at rest have nothing between them."""
        programme, told = self.path.work.programme, self.path.work.rig.description
        count = len(programme.time)
        if programme.poses:
            return Thinned(count, 1)
        return Thinned.of(count, programme.period, told.drive.smoothing, programme.rate)


def _moved_of(work: Work) -> Moved:
    """Efforts along the motion that is fed in: summed from directions where it is as recorded.

    Where an effect changes anything else of the model, or what a joint's sensor shows, most fits
    have a motion of their own, of which directions would not be used again.
    """
    nominal, content = _nominal(work.rig.model, work.ties)
    fed = _single(work)
    recorded = {j: work.programme.drive[s][:, 0] for j, s in fed}
    positions = {j: work.position(j, work.seen(s)[:, 0]) for j, s in fed}
    told = f"{work.rig.identity}{work.programme.identity}{work.stretch}"
    digest = hashlib.sha256(told.encode())
    for part in (work.model.qpos0, *positions.values()):
        digest.update(np.ascontiguousarray(part).tobytes())
    path = _Path(digest.hexdigest(), work, positions)
    as_recorded = all(np.array_equal(positions[j], recorded[j]) for j in recorded)
    alike = _bared(with_inertials_of(work.model, nominal), work.ties) if as_recorded else None
    if alike is not None and _content(alike) == content:
        motion = _Motion(path, _hash(content), as_recorded, nominal)
        size = size_of(nominal, len(work.programme.time))
        efforts = _efforts(nominal).of(motion, size, lambda: _made(motion))
        if efforts is not None and efforts.linear:
            return efforts.of(work.model)
    rigid = _rigid(work.model, work.ties)
    return _moved(_Motion(path, _hash(_content(rigid)), as_recorded, rigid))


@lru_cache(maxsize=4)
def _nominal(model: mujoco.MjModel, ties: Ties) -> tuple[mujoco.MjModel, bytes]:
    """The rigid model of a rig's own, and its numbers."""
    rigid = _rigid(model, ties)
    return rigid, _content(rigid)


@lru_cache(maxsize=2)
def _efforts(model: mujoco.MjModel) -> KeptEfforts:
    """Those of a rig's own model, along motions as they were recorded."""
    return KeptEfforts()


def _made(motion: _Motion) -> RigidEfforts:
    return RigidEfforts(motion.model, *motion.states(), motion.thinned.inverted)


@lru_cache(maxsize=KEPT)
def _moved(motion: _Motion) -> Moved:
    """Of any other one."""
    return motion.thinned.inverted(motion.model, *motion.states())


def _single(work: Work) -> list[tuple[str, str]]:
    """Joints of one coordinate that are fed in, with their signals."""
    joints = work.rig.description.drive.joints
    return [(j, s) for j, s in joints.items() if work.programme.drive[s].shape[1] == 1]


def needed_commands(work: Work, names: Sequence[str], moved: Moved) -> dict[str, FloatArray]:
    """The command (n,) of each actuator, less what it picks up of those to others."""
    talking = [e.parts for e, _ in work.effects if type(e).pick_up is not Effect.pick_up]
    every = dict.fromkeys([*names, *(other for _, *others in talking for other in others)])
    need = {name: _needed(work, name, moved) for name in every}
    found = {name: work.required(name, given) for name, given in need.items()}
    for _ in range(PICKED if talking else 0):
        found = {
            name: work.required(name, given - work.picked_up(name, found))
            for name, given in need.items()
        }
    return found


def _needed(work: Work, name: str, moved: Moved) -> FloatArray:
    """What must reach an actuator (n,), beside those that act on the same joints."""
    compared = [one.actuator for one in work.rig.description.compare.values() if one.actuator]
    found = _transmission(work.rig.model, name, tuple(compared))
    efforts = np.stack([needed_effort(work, joint, moved) for joint in found.joints])
    return found.command(work.model, name, efforts)


@lru_cache(maxsize=RECORDED)
def _transmission(model: mujoco.MjModel, name: str, compared: tuple[str, ...]) -> Transmission:
    """Of a rig's own model: one for all simulations of a diagnosis."""
    return Transmission.of(model, name, compared)


def needed_effort(work: Work, name: str, moved: Moved) -> FloatArray:
    """What must act at a joint of one coordinate (n,), for those that follow it, too."""
    effort = _effort_at(work, name, moved)
    if work.rig.description.drive.held:
        effort = shifted(effort, work.programme.time, -0.5 * work.programme.period)
    return effort


def _effort_at(work: Work, name: str, moved: Moved) -> FloatArray:
    """The same at the instant of each row."""
    model, joint = work.model, work.model.joint(name)
    dof = int(joint.dofadr[0])
    speed = moved.speed[:, dof]
    effort = moved.effort[:, dof] + work.carried(joint.name, moved.effort[:, dof], speed)
    effort = effort + float(model.dof_damping[dof]) * speed
    effort = effort + work.dry(joint.name, speed) + work.resistance(joint.name, speed)
    effort = effort + work.held(joint.name, moved.position[:, int(joint.qposadr[0])])
    effort = effort + work.coupled(joint.name, moved.speed)
    if any(law.kind is LawKind.EFFORT for law in work.laws):
        along = measured_variables(work, np.hstack([moved.position, moved.speed]))
        effort = effort - work.lawful(joint.name, along)
    for one in work.ties.after(joint.name):
        ratio = one.ratio(moved.position[:, int(joint.qposadr[0])])
        effort = effort + ratio * _effort_at(work, one.joint, moved)
    return np.asarray(effort)


def _states(path: _Path) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Qpos (n, nq), qvel and qacc (n, nv) of the motion that is fed in."""
    work = path.work
    told, model, programme = work.rig.description, work.model, work.programme
    rows = len(programme.time)
    q = np.tile(model.qpos0, (rows, 1))
    v, a = np.zeros((rows, model.nv)), np.zeros((rows, model.nv))
    for joint, signal in told.drive.joints.items():
        at, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])
        if joint not in path.positions:  # a free joint: MuJoCo has the scalar part first
            q[:, at : at + 7] = programme.drive[signal][:, [0, 1, 2, 6, 3, 4, 5]]
            if not programme.poses:
                _move_free(model, joint, work.period, told.drive.smoothing, (q, v, a))
            continue
        q[:, at] = path.positions[joint]
        if not programme.poses:
            smooth = smoothed(q[:, at], programme.period, told.drive.smoothing)
            q[:, at] = smooth
            v[:, dof] = np.gradient(smooth, work.period)
            a[:, dof] = np.gradient(v[:, dof], work.period)
    work.ties.follow(model, (q, v, a))
    return q, v, a


@lru_cache(maxsize=RECORDED)
def _kept_states(path: _Path) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of a path as it was recorded, along which every model of a fit is asked: read-only."""
    found = _states(path)
    for part in found:
        part.setflags(write=False)
    return found


def _move_free(
    model: mujoco.MjModel,
    joint: str,
    period: float,
    corner: float,
    states: tuple[FloatArray, FloatArray, FloatArray],
) -> None:
    """Smooth the pose of a free joint in q (n, nq), and write its rates into v and a (n, nv).

    Velocities are MuJoCo's: linear in the world, angular in the body.
    """
    q, v, a = states
    at, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])
    turn = q[:, at + 3 : at + 7]
    turn[1:] *= np.cumprod(np.where(np.sum(turn[1:] * turn[:-1], axis=1) < 0.0, -1.0, 1.0))[:, None]
    for column in range(at, at + 7):
        q[:, column] = smoothed(q[:, column], period, corner)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    rate = np.zeros(model.nv)
    for k in range(len(q)):
        before, after = max(k - 1, 0), min(k + 1, len(q) - 1)
        mujoco.mj_differentiatePos(model, rate, (after - before) * period, q[before], q[after])
        v[k, dof : dof + 6] = rate[dof : dof + 6]
    a[:, dof : dof + 6] = np.gradient(v[:, dof : dof + 6], period, axis=0)
