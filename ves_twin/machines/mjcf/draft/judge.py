"""Judge: efforts of a log against those that a model needs along the recorded motion."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.all_against import all_turned
from ves_twin.machines.mjcf.draft.changes import changes, misnamed
from ves_twin.machines.mjcf.draft.effort_fit import (
    LOADED,
    MOST,
    STRONG,
    TELLS,
    EffortFit,
    carried,
)
from ves_twin.machines.mjcf.draft.effort_sizes import ODD, constant_of, words_of_size
from ves_twin.machines.mjcf.draft.home_of import home_of
from ves_twin.machines.mjcf.draft.induced import words_of_noise
from ves_twin.machines.mjcf.draft.late import Pushed, words_of_lag
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.motion import Motion, motion_of
from ves_twin.machines.mjcf.draft.mounted import Mounted, mounted
from ves_twin.machines.mjcf.draft.rates import differs
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.draft.too_much_friction import too_much_friction
from ves_twin.machines.mjcf.motion.smoothed import smoothed
from ves_twin.machines.mjcf.parts.cyclic import turned_by
from ves_twin.machines.mjcf.parts.servo import is_servo
from ves_twin.machines.mjcf.rig.places import driven_joint

GAINED = 0.15
"""Share of one joint's power that a change must explain more to be proposed: well above what
signs and units that are right gain by chance on rough models."""

OFF = 0.1
"""Weight of a decade between an effort and what the model needs: a factor of 57 is no friction."""

SOUND = 0.1
"""Weight of an effort that the model explains a part of by a likely factor: a torque that follows
the sign of speed is explained by friction alone, whatever the position's zero (a pendulum that is
swung up: 0.87 with a zero upright, 0.94 hanging)."""

MAJORITY = 0.5
"""Share of the joints that a change is about beyond which the model must be right there: of one or
two that is all of them."""

ALIKE = 0.05
"""Difference of scores within which another change would do as well, and is told: of an arm with a
tip mass that its model lacks an angle from the world, degrees and a quarter turn came to that."""

TURN = 0.02
"""Weight against turning an effort's sign, so that where all else is equal none is turned."""

CLEAR = 0.7
"""Share of each effort that must be explained after a swap, friction and all, where less than MOST
was before: it is right, however little the model itself needs there (wrists of a UR10e). Of a unit
the size tells: in degrees any motion fits, by a slope of 20."""

NEAR = 1.5
"""Factor within which efforts fit a model under another gravity: its masses are about right."""

TOOL = 10.0
"""Factor within which efforts are those of a model that lacks a tool, in its own unit."""

_Asked = tuple[tuple[Match, ...], frozenset[str]]
"""Columns of a motion, and joints that efforts are told of."""


def _is_turned(new: list[Match], found: list[Match]) -> bool:
    """Whether a column counts the other way in a change."""
    return any(a.scale == -b.scale for a, b in zip(new, found, strict=True))


def _is_flipped(new: list[Match], found: list[Match]) -> bool:
    """Whether an angle is half a turn off in a change: of small ones a sign says the same."""
    return any(abs(a.zero - b.zero) == np.pi for a, b in zip(new, found, strict=True))


def _against(new: list[Match], found: list[Match]) -> float:
    """Weight against a change of a unit that the column's name tells, beside other changes."""
    pairs = zip(new, found, strict=True)
    return GAINED * any(a.unit != b.unit for a, b in pairs if b.told and a.column == b.column)


@dataclass(frozen=True)
class Judge:
    """Efforts of a log against those of a model.

    Attributes:
        log: the columns.
        model: the machine.
        corner: of the low-pass [Hz].
        locked: joints that are taken as standing still.
        cyclic: joints of which a speed is enough.
        drives: of a parallel machine the joints that all others follow; empty: there are no loops.
    """

    log: LogColumns
    model: mujoco.MjModel
    corner: float
    locked: tuple[str, ...] = ()
    cyclic: tuple[str, ...] = ()
    drives: tuple[str, ...] = ()
    _kept: dict[_Asked, Motion] = field(default_factory=dict, init=False, compare=False)

    def motion(self, found: list[Match]) -> Motion:
        """Along the positions as they are matched, and the speeds of joints without one.

        It is kept: a change of an effort's sign leaves it, and who weighs a change asks twice.
        """
        moving = tuple(m for m in found if m.spot.quantity is not Quantity.EFFORT)
        key = moving, frozenset(m.spot.joint for m in found) - {""}
        if key not in self._kept:
            self._kept[key] = self._motion(*key)
        return self._kept[key]

    def _motion(self, found: tuple[Match, ...], pushed: frozenset[str]) -> Motion:
        positions = {}
        for m in found:
            if self.drives and m.spot.name not in self.drives:
                continue  # it follows these
            if m.spot.quantity is Quantity.POSITION:
                home = home_of(m, self.model, self.log) if self.drives else None
                zero = home[0] * m.factor / m.scale if home else m.zero
                positions[m.spot.name] = m.factor * self.log.smooth(m.column, self.corner) + zero
            elif m.spot.quantity is Quantity.SPEED and m.spot.name in self.cyclic:
                speed = m.factor * self.log.column(m.column)
                time = np.arange(len(speed), dtype=float) * self.log.period
                turned = turned_by(speed, time)
                positions[m.spot.name] = smoothed(turned, self.log.period, self.corner)
        loops = bool(self.drives)
        return motion_of(self.model, positions, self.log.period, self.corner, loops, pushed)

    def corrected(self, found: list[Match]) -> tuple[list[Match], list[str], Mounted | None]:
        """With the changes of positions that explain more, the best first, and words for them.

        Where another gravity explains more than all of them, nothing is changed.
        """
        best, new, said = self._changed(found)
        motion = self.motion(found)
        fits = {m: self.fit(m, motion) for m in self.driving(found)}
        if turned := all_turned(found, fits, self.power(found, motion)):
            so, columns, words = self._changed(turned[0])
            if so > best - ALIKE:
                best, new, said = so, columns, [turned[1], *words]
        other = self.mounted(found)
        if other is None or other.score < self.score(found) + GAINED or other.score < best - ALIKE:
            return new, said, None
        if other.score > best + ALIKE or not said:
            return found, [other.words], other
        return new, [*said[:-1], f"{said[-1]}; or else: {other.words}"], None

    def _changed(self, found: list[Match]) -> tuple[float, list[Match], list[str]]:
        """The score that changes of positions come to, columns with them, words for each."""
        said: list[str] = []
        best = self.score(found)
        for _ in range(2 * len(found)):
            driven = {m.spot.joint for m in self.driving(found)}
            ways = changes(found, driven, self.model, self.reach(found))
            tried = [(self.score(new), new, words) for new, words in ways]
            better = [one for one in tried if one[0] >= best + GAINED]
            turned = any(_is_turned(new, found) for _, new, _ in better)
            ranked = [
                (one[0] - _against(one[1], found) - (turned and _is_flipped(one[1], found)), one)
                for one in better
            ]
            ranked.sort(key=lambda one: -one[0])
            sound = (one for one in ranked if self.sound(one[1][1], found))
            first = next(sound, None)
            if first is None:
                break
            alike = [one[2] for rank, one in sound if rank > first[0] - ALIKE]
            best, found, words = first[1]
            said.append(f"{words}; or else: {'; or '.join(alike)}" if alike else words)
        return best, found, said

    def mounted(self, found: list[Match]) -> Mounted | None:
        """Another gravity with which the model is right about columns as they are meant now.

        Efforts that tell it must fit as they are: a spring that the model lacks, or efforts that
        are turned, look like gravity at another scale.
        """
        other = mounted(self.model, lambda model: replace(self, model=model).score(found))
        if other is None:
            return None
        judge = replace(self, model=other.model)
        motion = judge.motion(found)
        fits = [judge.fit(m, motion) for m in judge.driving(found)]
        telling = [fit for fit in fits if fit.gain > STRONG]
        near = all(
            fit.slope > 0.0 if fit.free else 1.0 / NEAR < fit.slope < NEAR for fit in telling
        )
        return other if telling and near else None

    def reach(self, found: list[Match]) -> dict[str, float]:
        """Column of a position -> its largest number."""
        positions = (m.column for m in found if m.spot.quantity is Quantity.POSITION)
        return {name: float(np.max(np.abs(self.log.column(name)))) for name in positions}

    def sound(self, new: list[Match], found: list[Match]) -> bool:
        """Whether a change makes the model right about its joints: most of each effort, either way.

        In 3 s of slow motion columns are alike: a swap against the names of six torques explained
        more of them beside friction, by slopes of -0.2 and -29. Of three joints and more most are
        enough: a wrist's torque is all friction, whatever the unit of the angles. No swap is where
        friction would drive a joint then that it brakes as the columns are named.
        """
        old, motion = set(found), self.motion(new)
        changed = {m.spot.joint or m.spot.name for m in new if m not in old}
        now = {m.column: self.fit(m, motion) for m in self.driving(new) if m.spot.joint in changed}
        before = self.motion(found)
        was = {m.column: self.fit(m, before) for m in self.driving(found) if m.column in now}
        if self._hides(new, found, now.values()):
            return False
        swapped = any(a.column != b.column for a, b in zip(new, found, strict=True))
        if swapped and any(fit.pushes and not was[c].pushes for c, fit in now.items()):
            return False
        clear = all(fit.share > CLEAR and was[c].share < MOST for c, fit in now.items())
        if now and clear and all(a.unit == b.unit for a, b in zip(new, found, strict=True)):
            return True
        right = [fit.right for fit in now.values()]
        return not right or sum(right) > MAJORITY * len(right)

    def _hides(self, new: list[Match], found: list[Match], fits: Collection[EffortFit]) -> bool:
        """Whether a unit that a name tells is another one by efforts whose constant is open.

        In degrees a hub takes 57 times the torque a volt: nothing but its tip tells, which drifts.
        """
        reach = self.reach(found)
        renamed = any(
            b.told and a.unit != b.unit and not misnamed(b, reach.get(b.column, 0.0))
            for a, b in zip(new, found, strict=True)
        )
        return renamed and len(fits) > 0 and all(fit.free for fit in fits)

    def score(self, found: list[Match]) -> float:
        """Shares explained at all joints, less what factors, signs and speeds have against it."""
        motion, total = self.motion(found), -differs(self.log, found, self.corner)
        driven = set()
        for match in self.driving(found):
            fit, dof = self.fit(match, motion), self.dof(match)
            driven.add(dof)
            total += fit.share - TURN * (fit.sign < 0) - LOADED * fit.against
            total += SOUND * (fit.usable and fit.slope > 0.0 and not fit.free)
            if not match.indirect and fit.gain > STRONG and fit.slope:
                total -= OFF * min(abs(float(np.log10(abs(fit.slope)))), 3.0)
        still = {int(self.model.joint(name).dofadr[0]) for name in self.locked}
        for dof in set(range(self.model.nv)) - driven - self.pushed(found) - still:
            steady = motion.steady[:, dof]
            inertia, weight = motion.effort[:, dof] - steady, float(np.std(steady))
            if weight > 0.0 and 1.0 / ODD < float(np.std(inertia)) / weight < ODD:
                alike = float(np.corrcoef(-inertia, steady)[0, 1])
                total += max(alike, 0.0) ** 2
        return total

    def driving(self, found: list[Match]) -> list[Match]:
        """Efforts that act on one joint; what a servo is told is none."""
        efforts = (m for m in found if m.spot.quantity is Quantity.EFFORT and m.spot.joint)
        return [m for m in efforts if not is_servo(self.model, self.model.actuator(m.spot.name).id)]

    def pushed(self, found: list[Match]) -> set[int]:
        """Degrees of freedom of joints that are driven by efforts which no column tells."""
        told = {m.spot.name for m in self.driving(found)}
        motors = (i for i in range(self.model.nu) if self.model.actuator(i).name not in told)
        joints = {driven_joint(self.model, i) for i in motors}
        return {int(self.model.joint(name).dofadr[0]) for name in joints if name}

    def dof(self, match: Match) -> int:
        """That an effort acts on."""
        return int(self.model.joint(match.spot.joint).dofadr[0])

    def needed(self, match: Match, motion: Motion) -> FloatArray:
        """Command (m,) that the model needs of a motor along a motion."""
        return np.asarray(motion.effort[:, self.dof(match)] / self.gain(match))

    def gain(self, match: Match) -> float:
        """Effort at the joint for a command of 1."""
        actuator = self.model.actuator(match.spot.name)
        return float(actuator.gear[0] * actuator.gainprm[0]) or 1.0

    def smooth(self, match: Match) -> FloatArray:
        """A recorded effort (n,) in SI, low-passed as the motion."""
        return np.asarray(match.factor * self.log.smooth(match.column, self.corner))

    def recorded(self, match: Match, motion: Motion) -> FloatArray:
        """A recorded effort (m,) in SI, at the motion's rows."""
        return np.asarray(self.smooth(match)[motion.rows])

    def late(self, found: list[Match], motion: Motion) -> list[str]:
        """Efforts that do not come with the motion."""
        efforts = [
            Pushed(
                self.smooth(m),
                self.needed(m, motion),
                motion.speed[:, self.dof(m)],
                m.indirect,
            )
            for m in self.driving(found)
        ]
        return words_of_lag(efforts, motion.rows, self.log.period)

    def fit(self, match: Match, motion: Motion) -> EffortFit:
        """Of a recorded effort, in its unit's SI, beside friction."""
        y, need, dof = self.recorded(match, motion), self.needed(match, motion), self.dof(match)
        speed = motion.speed[:, dof]
        brakes = self.model.dof_damping[dof] * speed
        brakes = brakes + self.model.dof_frictionloss[dof] * np.sign(speed)
        return EffortFit.of(y, need, speed, match.indirect, brakes / self.gain(match))

    def along(self, found: list[Match], motion: Motion) -> Iterator[tuple[Match, FloatArray]]:
        """Each effort that acts on one joint, with what it is there (m,)."""
        for match in self.driving(found):
            yield match, self.gain(match) * self.recorded(match, motion)

    def power(self, found: list[Match], motion: Motion) -> float:
        """Mean of what all efforts give to their joints [W]: what friction takes, so above 0."""
        pairs = ((motion.speed[:, self.dof(m)], y) for m, y in self.along(found, motion))
        return sum(float(np.mean(speed * (y - carried(y, speed)))) for speed, y in pairs)

    def rough(self, found: list[Match], motion: Motion) -> list[str]:
        """Joints at which the model has more friction than what was measured."""
        measured = (pair for pair in self.along(found, motion) if not pair[0].indirect)
        along = {m.spot.joint: (effort, motion.speed[:, self.dof(m)]) for m, effort in measured}
        return too_much_friction(self.model, along)

    def efforts(self, found: list[Match], motion: Motion) -> tuple[list[Match], list[str]]:
        """With signs and constants of efforts as the motion needs them."""
        found, said = list(found), []
        for i, match in enumerate(found):
            if match not in self.driving(found) or match.column in self.log.steady:
                continue
            fit = self.fit(match, motion)
            if match.indirect and (fit.gain > TELLS or self.log.is_coarse(match.column)):
                told = self.by_inertia(match, motion), self.noisy(match, found, motion)
                found[i], words = constant_of(self.log, match, fit, found, *told)
                said += words
                continue
            if match.fitted:
                unread = f"{match.column} is {match.kind}: {match.constant}"
                said.append(f"{unread}; put {match.asked} there")
            turns = fit.sign < 0 and (fit.by_slope or self.power(found, motion) <= 0.0)
            if fit.sign < 0 and not (turns or fit.strange):
                said.append(
                    f"{match.column} brakes its joint more than it drives it (work {fit.work:.0%}):"
                    " look whether its sign is right; in a motion of several joints it may be"
                )
            elif turns:
                why = f"slope {fit.slope:.2f}" if fit.usable else f"work {fit.work:.0%}"
                if match.given:
                    said.append(
                        f"{match.column} acts against this model ({why}), and stays as it is given:"
                        " its sign, or a command that comes late in a closed loop"
                    )
                    continue
                found[i] = replace(match, scale=-match.scale)
                said.append(
                    f"{match.column} has the wrong sign for this model ({why}): it is turned; or"
                    " the position of its joint counts the other way"
                )
            said += words_of_size(self.log, match, fit)
        return found, said

    def by_inertia(self, match: Match, motion: Motion) -> bool:
        """Whether nothing but inertia tells a constant, as the model bears no load there."""
        dof = self.dof(match)
        steady, whole = (float(np.std(x[:, dof])) for x in (motion.steady, motion.effort))
        return steady <= MOST * whole

    def noisy(self, match: Match, found: list[Match], motion: Motion) -> str:
        """That noise of a position is much of what the model needs; empty where it is not."""
        inertia = float(self.model.dof_M0[self.dof(match)]) / self.gain(match)
        need, joint = self.needed(match, motion), match.spot.joint
        return words_of_noise(self.log, found, joint, need, inertia, self.corner)

    def lifting(self, found: list[Match], motion: Motion) -> list[tuple[int, FloatArray]]:
        """Degree of freedom and effort (m,) of each drive that the model is about right about."""
        fits = ((m, self.fit(m, motion)) for m in self.driving(found))
        known = [
            m
            for m, fit in fits
            if fit.gain > TELLS and (fit.free or 1.0 / TOOL < abs(fit.slope) < TOOL)
        ]
        return [(self.dof(m), effort) for m, effort in self.along(known, motion)]

    def explained(self, found: list[Match], motion: Motion) -> dict[str, float]:
        """Share of the power of each effort that the model as it is explains."""
        shares = {}
        for match in self.driving(found):
            y = self.recorded(match, motion)
            rest = y - self.needed(match, motion)
            power = float(np.sum((y - y.mean()) ** 2)) or 1.0
            shares[match.column] = max(1.0 - float(np.sum((rest - rest.mean()) ** 2)) / power, 0.0)
        return shares
