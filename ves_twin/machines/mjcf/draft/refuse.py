"""refuse: why no machine can be drafted from a log, in one line."""

from __future__ import annotations

from typing import NoReturn

import mujoco

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.check import Checked
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Matches
from ves_twin.machines.mjcf.draft.names import OTHER
from ves_twin.machines.mjcf.draft.spots import Quantity, single_joints, words_of
from ves_twin.machines.mjcf.parts.servo import is_servo

FRAME_POSITION = int(mujoco.mjtSensor.mjSENS_FRAMEPOS)

COUNTED = frozenset({"counts", "count", "cnt", "ticks", "pulses", "encoder", "enc"})
"""Words of what an encoder counts."""


def refuse(log: LogColumns, matches: Matches, check: Checked, model: mujoco.MjModel) -> NoReturn:
    """Say what is missing.

    Args:
        log: the columns.
        matches: as they were found.
        check: as the model corrected them.
        model: of the machine.

    Raises:
        InvalidInputError: always.
    """
    efforts = [m for m in check.found if m.spot.quantity is Quantity.EFFORT]
    there = ", ".join(f"{m.column}{' as an effort' * (m in efforts)}" for m in check.found)
    open_ = [column for column in matches.left if column not in log.empty]
    left = ", ".join([*open_, *matches.setpoints]) or "none"
    motors = ", ".join(model.actuator(i).name for i in range(model.nu))
    joints = ", ".join(model.joint(i).name for i in single_joints(model))
    lacks_effort = not efforts
    expected = f"an effort of {motors}" if lacks_effort else f"a position or speed of {joints}"
    if lacks_effort and left != "none":
        expected += _words_of_gears(model)
    placed = any(m.spot.quantity in (Quantity.POSITION, Quantity.SPEED) for m in check.found)
    if lacks_effort and not placed and model.nu:
        expected = f"{expected}, and a position or speed of {joints}"
    came = f"columns matched: {there or 'none'}; not matched: {left}"
    if log.empty:
        came += f"; a tenth empty: {', '.join(log.empty)}"
    if not model.nu:
        came = f"a model without actuators; {came}"
        expected = f"actuators, or a position of {joints} and what follows from it"
    sensors = (model.sensor(i) for i in range(model.nsensor))
    name = next((s.name for s in sensors if int(s.type[0]) == FRAME_POSITION), "")
    if name and not placed:
        expected += f"; of {name} alone the file is written by hand, with a [start] of {joints}"
    counted = [column for column in matches.left if _is_counted(column, log)]
    if counted and not (lacks_effort or placed):
        expected += f"; {', '.join(counted)} as m or rad: the model does not tell what a count is"
    elif joints and not placed and any(_is_open(column, log) for column in matches.left):
        named = joints.split(", ")[0]
        expected += f"; a column that holds one is read by a name like pos_{named} or q1"
        expected += f" (vel_{named} or dq1 of a speed): rename it"
    raise InvalidInputError(f"{log.file} does not fit the model", came, expected)


def _words_of_gears(model: mujoco.MjModel) -> str:
    """That set-points of servos with a gear are not read as such, if there are any."""
    geared = {
        model.actuator(i).name: float(model.actuator_gear[i, 0])
        for i in range(model.nu)
        if is_servo(model, i, geared=True) and not is_servo(model, i)
    }
    names = ", ".join(f"{name} has gear {gear:g}" for name, gear in geared.items())
    told = (
        f"; {names}, and set-points in degrees are read of a servo with gear 1: write them in rad"
    )
    return f"{told}, and their ratio to the command in --scale COLUMN=NUMBER" if geared else ""


def _is_open(column: str, log: LogColumns) -> bool:
    """Whether a column that is left over could be a joint's under another name."""
    return column in log.values and not OTHER & set(words_of(column))


def _is_counted(column: str, log: LogColumns) -> bool:
    return log.units.get(column) == "counts" or bool(COUNTED & set(words_of(column)))
