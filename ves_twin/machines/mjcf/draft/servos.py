"""followed: set-points of servos held against the positions that follow them: sign, unit, swap."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.changes import DEGREE, FAR_ROUND
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.parts.servo import is_servo

LONGEST = 0.5
"""Lag of a position behind its set-point that is looked for [s]; hobby servos take 0.05 to 0.2."""

FOLLOWS = 0.5
"""Share of a position that its set-point must explain, later, for the two to be held together: a
weak servo loses much of a fast set-point."""

CLEAR = 1.5
"""Times by which a set-point must leave less of its position where it comes after (no servo knows
ahead: the two are swapped), or where it is turned."""

MOST, LEAST = 2.0, 0.125
"""Times a set-point within which a position is a servo's that rings, or is weak (a hobby servo with
a load: 0.38 of a fast set-point)."""

NEAR = 3.0
"""Times by which a factor may differ from that of another unit: a weak servo loses as much."""

POSES = 200
"""Rows at which gravity is asked for."""


@dataclass(frozen=True)
class Following:
    """A position y(t) = slope * u(t - lag) + offset as a set-point u tells it.

    Attributes:
        slope: s.
        share: of the position's power that is explained.
        lag: that explains most [s].
    """

    slope: float
    share: float
    lag: float

    @staticmethod
    def of(u: FloatArray, y: FloatArray, period: float, way: int = 1) -> Following:
        """The lag that explains most; with a slope below zero only where that is clearly better.

        Of a motion that repeats half a period turns the sign.

        Args:
            u: set-point (n,).
            y: position (n,).
            period: of the rows [s].
            way: 1 for a position that comes later, -1 for one that comes before its set-point.
        """
        best = {sign: Following(0.0, 0.0, 0.0) for sign in (1.0, -1.0)}
        for k in range(min(int(LONGEST / period), len(u) // 3) + 1):
            later, first = (y[k:], u[: len(u) - k]) if way > 0 else (y[: len(y) - k], u[k:])
            a, b = first - first.mean(), later - later.mean()
            power = float(a @ a), float(b @ b)
            if min(power) <= 0.0:
                break
            along = float(a @ b)
            share, sign = along**2 / (power[0] * power[1]), float(np.sign(along)) or 1.0
            if share > best[sign].share:
                best[sign] = Following(along / power[0], share, way * k * period)
        turned = 1.0 - best[1.0].share > CLEAR * (1.0 - best[-1.0].share)
        return best[-1.0 if turned else 1.0]


def followed(
    log: LogColumns, found: list[Match], model: mujoco.MjModel
) -> tuple[list[Match], list[str]]:
    """Matches with set-points and positions of servos as they follow one another, and words."""
    found, said = list(found), []
    for command, position in list(_pairs(found, model)):
        new, words = _held(log, command, position, model)
        found = [new.get(m, m) for m in found]
        said += words
    return found, said


def _pairs(found: list[Match], model: mujoco.MjModel) -> Iterator[tuple[Match, Match]]:
    """Commands of servos with the positions of their joints."""
    positions = {m.spot.name: m for m in found if m.spot.quantity is Quantity.POSITION}
    for m in found:
        effort = m.spot.quantity is Quantity.EFFORT and m.spot.joint in positions
        if effort and is_servo(model, model.actuator(m.spot.name).id):
            yield m, positions[m.spot.joint]


def _held(
    log: LogColumns, command: Match, position: Match, model: mujoco.MjModel
) -> tuple[dict[Match, Match], list[str]]:
    """What is meant otherwise of a set-point and its position, and words for it."""
    u = command.factor * log.column(command.column)
    y = position.factor * log.column(position.column)
    told, before = Following.of(u, y, log.period), Following.of(u, y, log.period, -1)
    one, two = position.column, command.column
    ahead = before.lag < 0.0 and before.share > FOLLOWS
    if ahead and 1.0 - told.share > CLEAR * (1.0 - before.share) and command.unit == position.unit:
        new = {command: replace(command, column=one), position: replace(position, column=two)}
        words = f"{one} comes {-before.lag:.2g} s before its set-point {two}"
        return new, [f"{words}: taken the other way round"]
    if told.share < FOLLOWS:
        return {}, []
    new, said = _in_units(abs(told.slope), (command, u), (position, y))
    if told.slope < 0.0:
        turned, other = (
            (command, position) if _pulls(model, position, u, y) else (position, command)
        )
        meant = new.get(turned, turned)
        new[turned] = replace(meant, scale=-meant.scale)
        said.append(
            f"{one} moves against its set-point {two}: {turned.column} is turned; or it is"
            f" {other.column} that counts the other way"
        )
    return new, said


def _in_units(
    times: float, command: tuple[Match, FloatArray], position: tuple[Match, FloatArray]
) -> tuple[dict[Match, Match], list[str]]:
    """Angles that are degrees by their numbers; a factor that no servo has between the two."""
    fed, shown = command[0], position[0]
    if LEAST < times < MOST:
        named = [m for m, rows in (command, position) if _is_far(m, rows)]
        if len(named) < 2:
            return {}, []
        names = ", ".join(m.column for m in named)
        told = "named in rad, " * any(m.told for m in named)
        words = f"{names}: {told}the numbers fit the model as deg"
        return {m: replace(m, unit="deg") for m in named}, [words]
    for match, factor in ((shown, 1.0 / DEGREE), (fed, DEGREE)):
        near = 1.0 / NEAR < times / factor < NEAR
        if near and match.spot.unit == "rad" and match.unit == "rad" and not match.told:
            words = f"{match.column}: numbers fit the model as deg, not as rad"
            return {match: replace(match, unit="deg")}, [words]
    return {}, [
        f"{shown.column} moves by {times:.3g} times its set-point {fed.column}: another unit, or a"
        " gear? scale in the line of either makes them agree"
    ]


def _is_far(match: Match, values: FloatArray) -> bool:
    """Whether an angle in radians reaches turns that few joints have."""
    return match.unit == "rad" and match.spot.unit == "rad" and bool(np.ptp(values) > FAR_ROUND)


def _pulls(model: mujoco.MjModel, position: Match, u: FloatArray, y: FloatArray) -> bool:
    """Whether gravity asks for the set-point to be turned, and not the position.

    A servo gives kp (u - q), which at rest is what gravity takes there. With u turned that is
    -(u + y) at q = y, with the position turned u + y at q = -y.
    """
    data, joint = mujoco.MjData(model), model.joint(position.spot.name)
    at, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
    shown = 0.0
    for row in np.unique(np.linspace(0, len(y) - 1, POSES).astype(int)):
        for way in (1.0, -1.0):
            data.qpos[:] = model.qpos0
            data.qpos[at] = way * y[row]
            mujoco.mj_forward(model, data)
            shown -= (u[row] + y[row]) * float(data.qfrc_bias[dof])
    return shown > 0.0
