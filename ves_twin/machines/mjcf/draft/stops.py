"""beyond and beyond_*, in_degrees_by_stops: columns held against ranges of the model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.changes import DEGREE
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity, is_motor
from ves_twin.machines.mjcf.parts.joint_units import joint_units

FEWEST = 3
"""Joints whose angles must leave their stops as radians for all to be taken as degrees: one or two
may be told before a gear."""

NEAR = 0.1
"""Share of its range by which an angle may pass a stop: files round them."""

FAR = "another unit, or a motor before its gear?"
"""What is asked where a position leaves the range of its joint by more than that is wide."""

OVER = 1.5
"""Times its limit that an effort may come to: a file may give what a drive can bear for long."""


def beyond(log: LogColumns, found: list[Match], model: mujoco.MjModel) -> Iterator[str]:
    """Positions that leave the range of their joint, and what may be wrong by how far they do."""
    for match, low, high in _stopped(found, model):
        lowest, highest = _ends(log, match)
        over = max(low - lowest, highest - high) / (high - low)
        why = "another zero, sign, or joint?" if over < 1.0 else FAR
        if over > NEAR:
            yield (
                f"{match.column} goes from {lowest:.3g} to {highest:.3g} {match.spot.unit}, joint"
                f" {match.spot.name} from {low:.3g} to {high:.3g}: {why}"
            )


def beyond_control(log: LogColumns, found: list[Match], model: mujoco.MjModel) -> Iterator[str]:
    """Commands beyond the range that their actuator clips them to: MuJoCo cuts them silently."""
    for match in found:
        if match.spot.quantity is not Quantity.EFFORT or match.fitted:
            continue
        actuator = model.actuator(match.spot.name)
        low, high = map(float, actuator.ctrlrange)
        if not int(actuator.ctrllimited[0]):
            continue
        if match.spot.unit == "1" and match.unit in ("N", "N*m"):  # an effort, and no command
            continue
        values = match.factor * log.column(match.column)
        lowest, highest = float(np.min(values)), float(np.max(values))
        if max(low - lowest, highest - high) > NEAR * (high - low):
            yield (
                f"{match.column} goes from {lowest:.3g} to {highest:.3g}, {match.spot.label} takes"
                f" {low:.3g} to {high:.3g} (ctrlrange), a simulation clips the rest: another unit?"
            )


def beyond_limit(log: LogColumns, found: list[Match], model: mujoco.MjModel) -> Iterator[str]:
    """Efforts beyond what their joint may have, by the model's file: a URDF's `limit effort`."""
    for match in found:
        if match.spot.quantity is not Quantity.EFFORT or not match.spot.joint or match.indirect:
            continue
        number = int(model.actuator(match.spot.name).id)
        joint = int(model.joint(match.spot.joint).id)
        most = float(np.max(np.abs(model.jnt_actfrcrange[joint])))
        gain = float(model.actuator_gear[number, 0] * model.actuator_gainprm[number, 0])
        peak = float(np.max(np.abs(gain * match.factor * log.column(match.column))))
        if is_motor(model, number) and 0.0 < OVER * most < peak:
            unit = "N" if joint_units(model, match.spot.joint)[0] == "m" else "N*m"
            yield (
                f"{match.column} comes to {peak:.3g} {unit} at {match.spot.joint}, whose limit is"
                f" {most:.3g}: another unit, a gear, or a limit of another drive?"
            )


def in_degrees_by_stops(
    log: LogColumns, found: list[Match], model: mujoco.MjModel
) -> tuple[list[Match], list[str]]:
    """Angles of an arm in degrees where most of them leave the stops as radians, and none so.

    Whatever their names say: numbers beyond stops are no angles of these joints.
    """
    turning = [one for one in _stopped(found, model) if one[0].spot.unit == one[0].unit == "rad"]
    ends = [_ends(log, match) for match, _, _ in turning]
    left = within = 0
    for (_, low, high), (lowest, highest) in zip(turning, ends, strict=True):
        width = high - low
        left += max(low - lowest, highest - high) > width
        most = max(low - DEGREE * lowest, DEGREE * highest - high)
        within += most < NEAR * width
    if left < FEWEST or within < len(turning):
        return found, []
    every = [m for m in found if m.spot.quantity is Quantity.POSITION and m.unit == "rad"]
    named = "named in rad, " * any(m.told for m in every)
    words = f"{named}the numbers fit the stops of the joints as deg"
    changed = [replace(m, unit="deg") if m in every else m for m in found]
    return changed, [f"{', '.join(m.column for m in every)}: {words}"]


def _stopped(found: list[Match], model: mujoco.MjModel) -> Iterator[tuple[Match, float, float]]:
    """Positions of joints that have stops, with these."""
    for match in found:
        if match.spot.quantity is Quantity.POSITION:
            low, high = map(float, model.joint(match.spot.name).range)
            if low < high:
                yield match, low, high


def _ends(log: LogColumns, match: Match) -> tuple[float, float]:
    """The smallest and the largest position."""
    values = match.factor * log.column(match.column) + match.zero
    return float(np.min(values)), float(np.max(values))
