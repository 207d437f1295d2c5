"""Ties: joints that follow others by equalities of the model: gears, belts, mimic joints."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from ves_twin.core.types import FloatArray

JOINT = int(mujoco.mjtEq.mjEQ_JOINT)
POWERS = 5

KEPT = 64
"""Models, with the joints whose motion is known, whose ties are kept."""


@dataclass(frozen=True)
class Follower:
    """A joint that follows another one: y - y0 = c0 + c1 u + ... + c4 u^4, u = x - x0.

    Attributes:
        joint, leader: their names.
        powers: c0 to c4.
        home, base: y0 and x0, where the model has them [m or rad].
    """

    joint: str
    leader: str
    powers: tuple[float, ...]
    home: float
    base: float

    def ratio(self, leader: FloatArray, order: int = 1) -> FloatArray:
        """Slope dy/dx at positions of the leader (n,), or a further derivative."""
        return np.asarray(Polynomial(self.powers).deriv(order)(leader - self.base), float)

    def position(self, leader: FloatArray) -> FloatArray:
        """Where it stands at positions of the leader (n,)."""
        return np.asarray(self.home + Polynomial(self.powers)(leader - self.base), float)


@dataclass(frozen=True)
class Ties:
    """Joints that follow those whose motion is known, and where their efforts are felt.

    By virtual work what a joint needs, times dy/dx, is needed at the one that it is turned by.

    Attributes:
        followers: joints whose motion is not known by itself, each after its leader.
        turned: joints whose need is felt at another one, which is nearer to an actuator; each
            after that.
        loose: numbers of the equalities that the motion keeps by itself.
    """

    followers: tuple[Follower, ...] = ()
    turned: tuple[Follower, ...] = ()
    loose: tuple[int, ...] = ()

    @staticmethod
    def of(
        model: mujoco.MjModel,
        led: Collection[str],
        pushed: Collection[str] = (),
        locked: Collection[str] = (),
    ) -> Ties:
        """Of joints that move as recorded.

        Args:
            model: with its equalities.
            led: joints whose motion is known.
            pushed: those that efforts are told of; none: as many as are led.
            locked: joints that stand; none of them follows.
        """
        return _ties(model, *(tuple(sorted({*names})) for names in (led, pushed, locked)))

    def after(self, joint: str) -> list[Follower]:
        """Joints whose need is felt at one."""
        return [one for one in self.turned if one.leader == joint]

    def follow(
        self, model: mujoco.MjModel, states: tuple[FloatArray, FloatArray, FloatArray]
    ) -> None:
        """Write the followers into qpos (n, nq), qvel and qacc (n, nv)."""
        q, v, a = states
        for one in self.followers:
            (x, dx), (y, dy) = (_addresses(model, name) for name in (one.leader, one.joint))
            slope = one.ratio(q[:, x])
            q[:, y] = one.position(q[:, x])
            v[:, dy] = slope * v[:, dx]
            a[:, dy] = slope * a[:, dx] + one.ratio(q[:, x], 2) * v[:, dx] ** 2

    def at_leaders(self, model: mujoco.MjModel, q: FloatArray, efforts: FloatArray) -> FloatArray:
        """Efforts (n, nv) along qpos (n, nq), each with those that are felt there."""
        found = efforts.copy()
        for one in reversed(self.turned):
            x, dx = _addresses(model, one.leader)
            found[:, dx] += one.ratio(q[:, x]) * found[:, _addresses(model, one.joint)[1]]
        return found

    def free(self, model: mujoco.MjModel) -> None:
        """Switch the equalities off that the motion keeps."""
        model.eq_active0[list(self.loose)] = 0


@lru_cache(maxsize=KEPT)
def _ties(
    model: mujoco.MjModel, led: tuple[str, ...], pushed: tuple[str, ...], locked: tuple[str, ...]
) -> Ties:
    """Motion from the led ones on, efforts from the pushed ones that move."""
    free = {number: pair for number, pair in _edges(model) if not {*pair} & {*locked}}
    followers = _grown(model, led, free)
    moved = {*led, *(one.joint for one in followers)}
    tied = {number: pair for number, pair in free.items() if {*pair} <= moved}
    first = [name for name in pushed if name in moved]
    turned = _grown(model, first, tied)
    turned += _grown(model, (*led, *first, *(one.joint for one in turned)), tied)
    still = {*moved, *locked}
    loose = (number for number, pair in _edges(model) if {*pair} <= still)
    return Ties(tuple(followers), tuple(turned), tuple(loose))


def _grown(
    model: mujoco.MjModel, roots: Collection[str], edges: Mapping[int, tuple[str, str]]
) -> list[Follower]:
    """Joints that hang on some roots, themselves or by one another, none of them a root."""
    found, known, fresh = list[Follower](), {*roots}, [*roots]
    while fresh:
        leader = fresh.pop(0)
        for number, pair in edges.items():
            other = pair[pair[0] == leader]
            tied = leader in pair and other not in known
            one = _follower(model, number, other, leader) if tied else None
            if one is not None:
                found.append(one)
                known.add(other)
                fresh.append(other)
    return found


def _edges(model: mujoco.MjModel) -> Iterator[tuple[int, tuple[str, str]]]:
    """Number of each active equality of two joints, the one that follows by it, and the other."""
    for number in np.flatnonzero((model.eq_type == JOINT) & (model.eq_active0 != 0)).tolist():
        one, two = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        if two >= 0:
            yield number, (model.joint(one).name, model.joint(two).name)


def _follower(model: mujoco.MjModel, number: int, joint: str, leader: str) -> Follower | None:
    """One way round or the other, where that is a polynomial; else none."""
    powers = np.asarray(model.eq_data[number, :POWERS], float)
    home, base = (float(model.qpos0[_addresses(model, name)[0]]) for name in (joint, leader))
    if int(model.eq_obj1id[number]) != model.joint(joint).id:
        if powers[1] == 0.0 or np.any(powers[2:]):
            return None
        powers = np.array([-powers[0] / powers[1], 1.0 / powers[1]])
    return Follower(joint, leader, tuple(powers.tolist()), home, base)


def _addresses(model: mujoco.MjModel, joint: str) -> tuple[int, int]:
    """In qpos and qvel."""
    part = model.joint(joint)
    return int(part.qposadr[0]), int(part.dofadr[0])
