"""checked: columns held against the model by inverse dynamics: signs, units, swaps, by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import mujoco

from ves_twin.machines.mjcf.draft.angles import words_of_counted
from ves_twin.machines.mjcf.draft.closed_chain import closed_chain, words_of_open
from ves_twin.machines.mjcf.draft.flaws import words_of_flaws
from ves_twin.machines.mjcf.draft.judge import Judge
from ves_twin.machines.mjcf.draft.lacking import offsets_of
from ves_twin.machines.mjcf.draft.lifted import Load, lifted
from ves_twin.machines.mjcf.draft.locked import locked_joints, words_of_locked
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches
from ves_twin.machines.mjcf.draft.milli import in_milli
from ves_twin.machines.mjcf.draft.motion import Motion, band_of
from ves_twin.machines.mjcf.draft.rates import rated
from ves_twin.machines.mjcf.draft.rough import words_of_rough
from ves_twin.machines.mjcf.draft.scaled import scales_of, words_of_scale
from ves_twin.machines.mjcf.draft.servos import followed
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.draft.stops import (
    beyond,
    beyond_control,
    beyond_limit,
    in_degrees_by_stops,
)
from ves_twin.machines.mjcf.draft.swing import SHARE, turns_of
from ves_twin.machines.mjcf.draft.turns_back import words_of_one_way
from ves_twin.machines.mjcf.draft.unsigned import words_of_unsigned
from ves_twin.machines.mjcf.parts.cyclic import is_cyclic
from ves_twin.machines.mjcf.parts.loops import freedom
from ves_twin.machines.mjcf.parts.ties import Ties


@dataclass(frozen=True)
class Checked:
    """Matches as the model confirms or corrects them.

    Attributes:
        found: with signs, constants and units as the model needs them.
        findings: what was changed or looks wrong, a sentence each.
        explained: column of an effort -> share of its power that the model as it is explains.
        motion: efforts along the recorded motion; None where not every joint was recorded.
        corner: of the low-pass that was used [Hz].
        dofs: joint -> its degree of freedom.
        locked: joints that are taken as standing still.
        times: joint -> times what the model needs there that the log has, where it tells it.
        offsets: joint -> constant effort that the model lacks there, where that is much.
        lifts: last body of an arm -> what it can carry.
        rubs: columns of efforts that friction explains, and the model does not.
        gravity: that the model should have, as its file has it; empty where it is right.
    """

    found: tuple[Match, ...]
    findings: tuple[str, ...]
    explained: Mapping[str, float]
    motion: Motion | None
    corner: float
    dofs: Mapping[str, int]
    locked: tuple[str, ...] = ()
    times: Mapping[str, float] = field(default_factory=dict)
    lifts: Mapping[str, Load] = field(default_factory=dict)
    rubs: tuple[str, ...] = ()
    gravity: str = ""
    offsets: Mapping[str, float] = field(default_factory=dict)


ALIKE = 0.02
"""Share of efforts' power that the band of a joint's turns may explain less than that of its angle,
to be taken: below its turns a little is explained easily."""


def checked(log: LogColumns, matches: Matches, model: mujoco.MjModel) -> Checked:
    """Hold matched columns against the model, in the band of their motion.

    Of a joint that turns round and round that is the band of its turns, if these explain as much:
    how often it turns is known once its unit is.
    """
    plain = _checked(log, matches, model, _corner(log, matches, model, None))
    turns = _corner(log, matches, model, plain.found)
    if turns <= plain.corner:
        return plain
    wide = _checked(log, matches, model, turns)
    more, less = (sum(found.explained.values()) for found in (wide, plain))
    return wide if more > 0.0 and more >= less - ALIKE * len(wide.explained) else plain


def _corner(
    log: LogColumns, matches: Matches, model: mujoco.MjModel, found: Sequence[Match] | None
) -> float:
    """Of the low-pass [Hz] by which motions are differentiated, turns by columns as `found`."""
    cyclic, loops = _cyclic(matches, model), bool(_drives(matches, model))
    moving = matches.of(Quantity.POSITION)
    moving = moving or [m for m in matches.found if m.spot.name in cyclic]
    bands = [band_of(log.column(m.column), log.period, SHARE) for m in moving]
    for match in found or ():
        bands.append(turns_of(log, match, model, loops))
    band = max(bands, default=1.0)
    return min(4.0 * max(band, 1.0 / (log.period * log.rows)), 0.2 / log.period)


def _checked(log: LogColumns, matches: Matches, model: mujoco.MjModel, corner: float) -> Checked:
    """Hold matched columns against the model, low-passed.

    Where all joints were recorded, efforts of the model along the motion are fitted to the
    recorded ones beside friction: y = s tau + c v + k sign v + o. A negative s is a wrong sign, an
    s of 57 degrees. Columns are turned, swapped or rescaled only where that explains GAINED more,
    the change that explains most first.
    """
    positions = matches.of(Quantity.POSITION)
    locked, cyclic = locked_joints(model, matches.found), _cyclic(matches, model)
    moved = {*(m.spot.name for m in positions), *locked, *cyclic}
    ties = Ties.of(model, moved, locked=locked)
    moved |= {one.joint for one in ties.followers}
    drives = _drives(matches, model)
    every = [model.joint(i).name for i in range(model.njnt)]
    moved |= {*every} if drives else set()
    dofs = {name: int(model.joint(name).dofadr[0]) for name in every if name}
    absent = [name for name in every if name not in moved]
    found, findings = followed(log, list(matches.found), model)
    found, said = in_degrees_by_stops(log, found, model)
    findings += [*said, *words_of_locked(locked, ties.followers)]
    motion, explained, scales = None, dict[str, float](), dict[Match, float]()
    lifts: Mapping[str, Load] = {}
    rubs, gravity, offsets = tuple[str, ...](), "", dict[str, float]()
    before = len(findings)
    if absent or not (positions or cyclic):
        words = ", ".join(name or "one without a name" for name in absent)
        findings.append(f"signs are not checked: no column tells the position of {words}")
    else:
        judge = Judge(log, model, corner, locked, cyclic, drives)
        plain, named = judge, found
        found, said, other = judge.corrected(found)
        if other is not None:  # columns are held against the machine as it stands
            judge, gravity = replace(judge, model=other.model), other.numbers
        motion = judge.motion(found)
        if apart := words_of_open(motion):  # nothing is read off a machine that comes apart
            apart += beyond(log, named, model)
            return Checked(tuple(named), (*findings, *apart), {}, None, corner, dofs, locked)
        findings += said
        found, said = in_milli(found, {m: judge.fit(m, motion) for m in judge.driving(found)})
        findings += said
        found, said = judge.efforts(found, motion)
        findings += said
        scales = scales_of({m: judge.fit(m, motion) for m in judge.driving(found)})
        unsigned, late = words_of_unsigned(judge, found, motion), judge.late(found, motion)
        findings += [*words_of_scale(scales), *unsigned, *late, *judge.rough(found, motion)]
        lifts, rubs = _lifts(judge, found, motion), _rubs(judge, found, motion)
        offsets = offsets_of(judge, found, motion)
        motion = plain.motion(found)
        explained = plain.explained(found, motion)
        findings += words_of_one_way(motion, dofs, [m.spot.joint for m in judge.driving(found)])
    lost = [*words_of_flaws(log, found), *words_of_rough(log, found)]
    far = [f for told in (beyond, beyond_control, beyond_limit) for f in told(log, found, model)]
    findings[before:before] = [*lost, *words_of_counted(log, found), *far]
    found, said = rated(log, found, corner, model)
    times = {match.spot.joint: scale for match, scale in scales.items()}
    told = (*findings, *said)
    return Checked(
        tuple(found),
        told,
        explained,
        motion,
        corner,
        dofs,
        locked=locked,
        times=times,
        lifts=lifts,
        rubs=rubs,
        gravity=gravity,
        offsets=offsets,
    )


def _lifts(judge: Judge, found: list[Match], motion: Motion) -> Mapping[str, Load]:
    """Last body of an arm -> what it can carry."""

    def moved(other: mujoco.MjModel) -> Motion:
        return replace(judge, model=other).motion(found)

    return lifted(judge.model, moved, judge.lifting(found, motion))


def _rubs(judge: Judge, found: list[Match], motion: Motion) -> tuple[str, ...]:
    """Columns of efforts that friction explains, and the model does not."""
    return tuple(m.column for m in judge.driving(found) if judge.fit(m, motion).rubs)


def _drives(matches: Matches, model: mujoco.MjModel) -> tuple[str, ...]:
    """Joints of a parallel machine that have effort and position, where these leave no motion.

    None where drives are more than motions: efforts against each other show in none.
    """
    told = {m.spot.name for m in matches.of(Quantity.POSITION)}
    both = [m.spot.joint for m in matches.of(Quantity.EFFORT) if m.spot.joint in told]
    felt = closed_chain(model, tuple(dict.fromkeys(both)))
    return tuple(felt) if felt and len(felt) == freedom(model) else ()


def _cyclic(matches: Matches, model: mujoco.MjModel) -> tuple[str, ...]:
    """Joints of which a speed alone is told, which is enough: where they stand changes nothing."""
    told = {m.spot.name for m in matches.of(Quantity.POSITION)}
    speeds = dict.fromkeys(m.spot.name for m in matches.of(Quantity.SPEED))
    return tuple(name for name in speeds if name not in told and is_cyclic(model, name))
