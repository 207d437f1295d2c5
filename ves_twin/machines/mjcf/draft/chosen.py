"""Chosen: what is fed in and what is compared, by what the columns can bear."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.check import Checked
from ves_twin.machines.mjcf.draft.closed_chain import closed_chain
from ves_twin.machines.mjcf.draft.estimates import noise_of, rest_of, travel
from ves_twin.machines.mjcf.draft.home_of import FIRST, home_of
from ves_twin.machines.mjcf.draft.induced import differentiations, induced, with_motion
from ves_twin.machines.mjcf.draft.led import at_leader, felt_inertia
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches
from ves_twin.machines.mjcf.draft.motion import band_of
from ves_twin.machines.mjcf.draft.names import is_command, is_effort
from ves_twin.machines.mjcf.draft.refuse import refuse
from ves_twin.machines.mjcf.draft.spots import ON_JOINT, Quantity, is_motor, single_joints
from ves_twin.machines.mjcf.draft.swing import SHARE, turns_of
from ves_twin.machines.mjcf.parts.chain import chain
from ves_twin.machines.mjcf.parts.cyclic import is_cyclic
from ves_twin.machines.mjcf.parts.ties import Ties
from ves_twin.machines.mjcf.rig.description import CORNER, Mode

BAND = 2.0
"""Band that is analysed where motion is given, as a multiple of that which has 99 % of the power
of the efforts: reversals of friction are above it."""

RATES = (20.0, 100.0)
"""Least and largest analysis rate [Hz]; the second is that of files that say none."""

ENOUGH = 115
"""Rows of the analysis that a log must leave: a diagnosis asks for 100, its low-pass takes 10."""

LOST = 0.1
"""Share of an effort's power above the band of a diagnosis that is told."""

DROWNED = 0.05
"""Share of an effort that noise of positions may make once they are differentiated twice."""

LOUD = 0.5
"""The same where a lower band would cut what the positions swing in: above it they swing in noise
(a ramp at one speed, of which nothing else is left once its line is taken off)."""


@dataclass(frozen=True)
class Chosen:
    """What a drafted file says of its mode.

    Attributes:
        mode: MOTION where every joint is recorded, has a motor, and its position is good enough to
            be differentiated twice; else CONTROL.
        why: in words.
        rate: of the analysis [Hz].
        rated: why it is that, in words.
        integrated: joints in MOTION of which a speed alone is told, and enough.
        smoothing: corner of the low-pass of positions [Hz].
        noise: column -> sd of one row in SI, and how it was told.
        either: the motion could be given as well.
        imposed: joints that move as recorded in CONTROL, since no column tells what moves them.
        horizon: pieces that are simulated from a start of their own [s]; 0: the whole log.
        homes: column -> what is added to it, in its unit, to make it a position, and why.
        typical: joint without a column -> effort, speed and travel that the model gives it [SI].
    """

    mode: Mode
    why: str
    rate: float
    smoothing: float
    noise: Mapping[str, tuple[float, str]]
    either: bool = False
    imposed: tuple[str, ...] = ()
    horizon: float = 0.0
    homes: Mapping[str, tuple[float, str]] = field(default_factory=dict)
    typical: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    rated: str = "the efforts have no more in them"
    integrated: tuple[str, ...] = ()


def chosen(
    log: LogColumns,
    matches: Matches,
    check: Checked,
    model: mujoco.MjModel,
    closed: str | None = None,
) -> Chosen:
    """Choose the mode.

    A motor without a column moves its joint all the same: by what, nothing tells. Its motion is fed
    in, and the efforts of others are compared.

    Where motion is given, the band is that of the efforts, or the lower one in which the noise of
    differentiated positions stays below DROWNED: it grows with the band's power of 2.5 (of speeds:
    1.5). A short log, which leaves few rows in that band, is predicted from its efforts instead;
    where that tells nothing, either, more rows are taken than the band has.

    Args:
        log: the columns.
        matches: as they were found.
        check: as the model corrected them.
        model: of the machine.
        closed: why nothing can be predicted open loop; None: as far as is known, it can.

    Raises:
        InvalidInputError: no effort or command, or nothing that could be compared with it.
    """
    efforts = [m for m in check.found if m.spot.quantity is Quantity.EFFORT]
    positions = [m for m in check.found if m.spot.quantity is Quantity.POSITION]
    shaken = () if model.nu else _shaken(positions, model)
    if shaken and len(shaken) == len(check.found) and _is_free(log, matches, model):
        return _let_go(log, check, positions)
    if not (efforts or shaken) or len(efforts) + len(shaken) == len(check.found):
        refuse(log, matches, check, model)
    noise = _noise(log, check, positions)
    if shaken:
        return _of_base(log, check, model, noise, shaken)
    told = {m.spot.name for m in positions}
    moving = [*positions, *_summed(log, check, efforts, told, model)]
    moved = {m.spot.name for m in moving}
    leads = {one.joint: one for one in Ties.of(model, moved, locked=check.locked).followers}
    geared = felt_inertia(efforts, leads, model)
    efforts = [at_leader(m, leads) for m in efforts]
    pushed = [m.spot.joint for m in efforts if _is_plain(m, model)]
    driven, together = set(pushed), sorted({j for j in pushed if pushed.count(j) > 1})
    single = {model.joint(i).name for i in single_joints(model)} - {*check.locked, *leads}
    unknown = _moved_by(model) & single - {m.spot.joint for m in efforts}
    imposed = tuple(sorted(unknown & told))
    drives = [m for m in efforts if _is_plain(m, model) and m.spot.joint in told]
    wide = model.nv - len(check.locked) - len(leads)
    felt = closed_chain(model, [m.spot.joint for m in drives])
    steady = [m.column for m in efforts if m.column in log.steady]
    if felt and not steady:
        moved_by = [m for m in positions if m.spot.name in felt]
        return _of_loops(log, moved_by, drives, model, noise, felt)
    whole = check.motion is not None and single <= moved and wide == len(single) and not together
    if not whole or driven | unknown != single or not driven:
        free = sorted(single - driven)
        why = f"no effort is told at {', '.join(free)}" if free else "not every position is told"
        if together:
            why = f"of what pushes {', '.join(together)} a motion tells the sum alone; write that"
            why += ' sum as the column of one actuator (columns = ["a + b"]), and it is compared'
        return Chosen(Mode.CONTROL, why, RATES[1], check.corner, noise, imposed=imposed)
    if steady:
        why = f"{', '.join(steady)} never changes, and what never changes is a command"
        return Chosen(Mode.CONTROL, why, RATES[1], check.corner, noise, imposed=imposed)
    positions = [m for m in moving if m.spot.name in driven]
    why = "every joint has a position and an effort"
    if summed := ", ".join(sorted(moved - told)):
        why = f"every joint has a motion and an effort; the speed of {summed} is integrated"
    if unknown:
        why = f"every joint has a position; what moves {', '.join(imposed)} is not told"
    otherwise = Chosen(Mode.CONTROL, why, RATES[1], check.corner, noise, True, imposed)
    return _of_motion(otherwise, log, efforts, positions, model, closed, geared)


def _of_motion(
    otherwise: Chosen,
    log: LogColumns,
    efforts: list[Match],
    positions: list[Match],
    model: mujoco.MjModel,
    closed: str | None,
    geared: Mapping[str, float],
) -> Chosen:
    """Motion given, in a band that positions can bear; otherwise efforts, if these tell anything.

    Args:
        otherwise: mode CONTROL, with the noise; why motion could be given.
        log: the columns.
        efforts: that are compared.
        positions: of joints that are driven.
        model: of the machine.
        closed: why nothing can be predicted open loop; None: as far as is known, it can.
        geared: inertia that is felt where another joint's motor turns one.
    """
    noise, band = dict(otherwise.noise), _band(log, efforts)
    shares = [induced(m, noise, efforts, model, log, band, felt=geared)[1] for m in positions]
    powers = [1.0 / (differentiations(m) + 0.5) for m in positions]
    quiet, loud = (
        band * min((most / max(share, 1e-9)) ** k for share, k in zip(shares, powers, strict=True))
        for most in (DROWNED, LOUD)
    )
    least = 0.5 * RATES[0] if closed is None else min(_swung(log, positions, model), loud)
    band = max(min(band, quiet), least)
    length, rate, rated = log.period * log.fewest, 2.0 * band, Chosen.rated
    if rate * length < ENOUGH:
        if closed is None:
            rows = rate * length
            why = f"{length:.2g} s of motion leave {rows:.0f} rows in the band of the efforts"
            return replace(otherwise, why=why)
        rate, rated = ENOUGH / length, "as many rows as a diagnosis needs"
    if rate > 1.0 / log.period:
        rate, rated = 1.0 / log.period, "every row"
    rate = _in_whole_rows(rate, log)
    band = min(band, 0.5 * rate) if rated != Chosen.rated else 0.5 * rate
    sharp = {
        m.column: induced(m, noise, efforts, model, log, band, rate, geared) for m in positions
    }
    worst = max(sharp, key=lambda column: sharp[column][1])
    summed = {m.column: m.spot.name for m in positions if differentiations(m) == 1}
    if sharp[worst][1] > DROWNED and closed is None:
        share, twice = sharp[worst][1], " twice" * (worst not in summed)
        why = f"{worst} is too noisy to be differentiated{twice} ({share:.0%} of the effort)"
        return replace(otherwise, why=why)
    of_joint = {m.spot.name: sharp[m.column][0] for m in positions}
    for m in efforts:
        noise[m.column] = with_motion(noise[m.column], of_joint[m.spot.joint])
    why = (closed or otherwise.why) + _beyond(efforts, log, band)
    names = tuple(summed.values())
    return Chosen(Mode.MOTION, why, rate, CORNER * band, noise, rated=rated, integrated=names)


def _swung(log: LogColumns, positions: Sequence[Match], model: mujoco.MjModel) -> float:
    """Band [Hz] that efforts of a motion need at least: BAND times what its positions have."""
    bands = [band_of(log.column(m.column), log.period, SHARE) for m in positions]
    return BAND * max(*bands, *(turns_of(log, m, model) for m in positions))


def _in_whole_rows(rate: float, log: LogColumns) -> float:
    """The rate of as many whole rows as leave ENOUGH, where the nearest number leaves fewer.

    An analysis takes every n-th row: of 300 rows at 83 Hz a rate of 32 Hz is every third, 90 rows.
    """
    every = 1.0 / (rate * log.period)
    if log.fewest / max(round(every), 1) >= ENOUGH:
        return rate
    return 1.0 / (max(int(every), 1) * log.period)


def _band(log: LogColumns, followed: Sequence[Match]) -> float:
    """Band [Hz] of what is compared, within that of an analysis and of the log."""
    band = BAND * max(band_of(log.column(m.column), log.period, SHARE) for m in followed)
    return float(np.clip(band, 0.5 * RATES[0], min(0.5 * RATES[1], 0.25 / log.period)))


def _noise(
    log: LogColumns, check: Checked, positions: Sequence[Match]
) -> dict[str, tuple[float, str]]:
    """Column -> sd of one row in SI, and how it was told."""
    moved = [m.factor * log.column(m.column) for m in positions]
    rest, found = rest_of(moved, log.period), {}
    for m in check.found:
        values, period = log.readings(m.column)
        still = None if m.column in log.slower else rest
        values = values if still is None else log.column(m.column)
        effort = m.spot.quantity is Quantity.EFFORT
        put_out = effort and is_command(log.said.get(m.column, m.column))
        sd, how = noise_of(values, period, still, put_out, effort and not put_out)
        found[m.column] = (abs(m.factor) * sd, how)
    return found


def _beyond(efforts: Sequence[Match], log: LogColumns, band: float) -> str:
    """That an effort has much of its power above the band in which motion tells it, if one has."""
    shares = {}
    for m in efforts:
        values = log.column(m.column)  # whole: a quarter of a short log has no slow motion
        power = np.square(np.abs(np.fft.rfft(np.hanning(len(values)) * (values - values.mean()))))
        above = np.fft.rfftfreq(len(values), log.period) > band
        shares[m.column] = float(np.sum(power[above]) / max(np.sum(power), 1e-300))
    most = max(shares, key=lambda column: shares[column])
    if shares[most] < LOST:
        return ""
    return f"; {shares[most]:.0%} of the power of {most} lies above {band:.0f} Hz and is left out"


def _shaken(positions: list[Match], model: mujoco.MjModel) -> tuple[str, ...]:
    """Joints by which a model without actuators is shaken: those measured nearest to the world."""
    bodies = {m.spot.name: int(model.joint(m.spot.name).bodyid[0]) for m in positions}
    nearest = {
        name: not any(above in bodies.values() for above in chain(model, body) if above != body)
        for name, body in bodies.items()
    }
    return tuple(sorted(name for name, near in nearest.items() if near))


def _is_free(log: LogColumns, matches: Matches, model: mujoco.MjModel) -> bool:
    """Whether every joint is measured, and no column tells an effort that the model cannot take."""
    told = {m.spot.name for m in matches.of(Quantity.POSITION)}
    whole = told == {model.joint(i).name for i in range(model.njnt)}
    return whole and not any(is_effort(c, log.units.get(c, "")) for c in matches.left)


def _let_go(log: LogColumns, check: Checked, positions: list[Match]) -> Chosen:
    """Of a model without actuators of which nothing is measured but what swings freely."""
    noise, band = _noise(log, check, positions), _band(log, positions)
    why = "no actuator drives the model: it is let go, and nothing is fed in"
    return Chosen(Mode.CONTROL, why, 2.0 * band, check.corner, noise)


def _of_base(
    log: LogColumns,
    check: Checked,
    model: mujoco.MjModel,
    noise: dict[str, tuple[float, str]],
    imposed: tuple[str, ...],
) -> Chosen:
    """Of a model that is shaken: the band is that of what is compared."""
    followed = [m for m in check.found if m.spot.name not in imposed]
    band = _band(log, followed)
    verb = "moves" if len(imposed) == 1 else "move"
    why = f"no actuator drives the model: {', '.join(imposed)} {verb} as recorded"
    homes = {m.column: home for m in followed if (home := _sensed_home(m, model, log))}
    return Chosen(Mode.CONTROL, why, 2.0 * band, CORNER * band, noise, imposed=imposed, homes=homes)


def _sensed_home(match: Match, model: mujoco.MjModel, log: LogColumns) -> tuple[float, str] | None:
    """What makes a place that is told from elsewhere the model's [its unit]; None if it is."""
    if match.spot.quantity is not Quantity.SENSOR or match.spot.unit != "m":
        return None
    values, data = match.factor * log.column(match.column), mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    at = int(model.sensor(match.spot.name).adr[0]) + match.spot.axis
    begin, zero = float(np.mean(values[:FIRST])), float(data.sensordata[at])
    if abs(begin - zero) < 2.0 * travel(values):
        return None
    unit = match.factor / match.scale
    return (zero - begin) / unit, "offset: as if the log began where the model stands"


def _of_loops(
    log: LogColumns,
    positions: list[Match],
    drives: list[Match],
    model: mujoco.MjModel,
    noise: dict[str, tuple[float, str]],
    felt: Mapping[str, float],
) -> Chosen:
    """Of a parallel machine: its drives move as recorded, all else follows, efforts are compared.

    The band is that of the efforts, or in which differentiated noise stays below DROWNED.
    """
    band = _band(log, drives)
    share = max(induced(m, noise, drives, model, log, band, felt=felt)[1] for m in positions)
    band = max(min(band, band * (DROWNED / max(share, 1e-9)) ** 0.4), 0.5 * RATES[0])
    of_joint = {
        m.spot.name: induced(m, noise, drives, model, log, band, felt=felt)[0] for m in positions
    }
    for m in drives:
        noise[m.column] = with_motion(noise[m.column], of_joint[m.spot.joint])
    why = "the model's loops leave no motion but that of its drives, which have positions"
    homes = {m.column: home for m in positions if (home := home_of(m, model, log))}
    names = tuple(m.spot.name for m in positions)
    return Chosen(Mode.CONTROL, why, 2.0 * band, CORNER * band, noise, imposed=names, homes=homes)


def _summed(
    log: LogColumns,
    check: Checked,
    efforts: Sequence[Match],
    told: Container[str],
    model: mujoco.MjModel,
) -> list[Match]:
    """Speeds of joints without a position, where that changes no effort: their integral is enough.

    None behind volts, or a command, whose constant is fitted: by a motion it has the error of the
    model's inertia in it (see `as_commanded`).
    """
    for m in efforts:
        if m.fitted and (m.unit in ("V", "mV") or is_command(log.said.get(m.column, m.column))):
            return []
    speeds = [m for m in check.found if m.spot.quantity is Quantity.SPEED]
    return [m for m in speeds if m.spot.name not in told and is_cyclic(model, m.spot.name)]


def _is_plain(match: Match, model: mujoco.MjModel) -> bool:
    return bool(match.spot.joint) and is_motor(model, model.actuator(match.spot.name).id)


def _moved_by(model: mujoco.MjModel) -> set[str]:
    """Joints that an actuator moves."""
    drives = [model.actuator(i) for i in range(model.nu)]
    return {model.joint(int(d.trnid[0])).name for d in drives if int(d.trntype[0]) == ON_JOINT}
