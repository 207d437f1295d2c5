"""RigLaws: laws of a plant in the compiled loop, efforts at each step and readings at each row."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray, Record
from ves_twin.effects.law import Law, LawKind, held_words
from ves_twin.effects.law_kernel import (
    ASKED,
    DOF,
    FIRST_VALUE,
    HELD,
    HOLD,
    MESH,
    PLAY,
    SHAPE,
    SLIDER,
    CompiledLaws,
    law_efforts,
    law_value,
)
from ves_twin.plant.rig_laws import LAW_PLACES, READ
from ves_twin.simulator.pose_of import read_pose
from ves_twin.simulator.signal_bus import SLICES

WRENCH, WRENCH_END = SLICES["sensor.wrench"].start, SLICES["sensor.wrench"].stop
"""Columns of a row that the computers read as well as the recorder."""

_COLUMNS = {
    column: SLICES[name].start + n
    for name in READ
    for n, column in enumerate(SIGNALS[name].columns)
}


class RigLaws(NamedTuple):
    """What the loop needs of laws, and room for what they depend on, by place.

    Efforts have numbers of places, readings columns of a row. `applied` and `smooth` are live views
    of mjData. A law of a reading changes what is recorded; of the force sensor what the computers
    are told, too.
    """

    efforts: CompiledLaws
    readings: CompiledLaws
    applied: FloatArray
    smooth: FloatArray
    position: FloatArray
    speed: FloatArray
    command: FloatArray
    load: FloatArray
    own: FloatArray


def rig_laws(laws: Sequence[Law], data: mujoco.MjData) -> RigLaws:
    """Laws of a plant for a rig's data."""

    def number(what: str, name: str) -> int:
        return LAW_PLACES.index(name)

    efforts = [law for law in laws if law.kind is LawKind.EFFORT]
    readings = [law for law in laws if law.kind is LawKind.READING]
    return RigLaws(
        CompiledLaws.of(efforts, LAW_PLACES.index, number),
        CompiledLaws.of(readings, _COLUMNS.__getitem__, number),
        data.qfrc_applied,
        data.qfrc_smooth,
        *(np.zeros(len(LAW_PLACES)) for _ in range(5)),
    )


def forget_range(laws: RigLaws) -> None:
    """Begin anew to count how often laws are asked beyond their knots."""
    for memory in (laws.efforts.memory, laws.readings.memory):
        memory[:, [ASKED, HELD]] = 0.0


def held_laws(told: Sequence[Law], laws: RigLaws) -> list[str]:
    """What a log should say of laws that were asked beyond their knots.

    Args:
        told: laws of the plant.
        laws: the same, as they were run.
    """
    found = []
    for kind, run in ((LawKind.EFFORT, laws.efforts), (LawKind.READING, laws.readings)):
        own = [law for law in told if law.kind is kind]
        for law, row in zip(own, run.memory, strict=True):
            if row[HELD] > 0.0:
                found.append(held_words(law, row[HELD] / row[ASKED], "steps"))
    return found


@compiled
def look(
    p: Record, s: Record, qpos: FloatArray, qvel: FloatArray, slides: FloatArray,
    speeds: FloatArray, laws: RigLaws,
) -> None:  # fmt: skip
    """Write what laws depend on as it is now."""
    for i in range(6):
        laws.position[i] = slides[p.layout.slide_at[i]] - p.layout.slide_home[i]
        laws.speed[i] = speeds[p.layout.speed_at[i]]
        laws.command[i] = s.current[i]
        laws.speed[9 + i] = qvel[p.layout.platform_dof + i]
    for j in range(3):
        laws.position[6 + j] = qpos[p.layout.arm_qpos[j]]
        laws.speed[6 + j] = qvel[p.layout.arm_dof[j]]
        laws.command[6 + j] = s.work.torque[j]
    read_pose(p, qpos, laws.position[9:])


@compiled
def push_laws(p: Record, s: Record, time: float, ctrl: FloatArray, laws: RigLaws) -> None:
    """Add the efforts of a step to what the rods' motors and the joints get; after `look`."""
    arm, platform = p.layout.arm_dof, p.layout.platform_dof
    for i in range(6):
        at = platform + i
        laws.load[i] = s.rod_force[i]
        laws.load[9 + i] = laws.smooth[at] - laws.applied[at]
    for j in range(3):
        laws.load[6 + j] = laws.smooth[arm[j]] - laws.applied[arm[j]]
    law_efforts(time, laws.position, laws.speed, laws.command, laws.load, laws.efforts, laws.own)
    for i in range(6):
        ctrl[p.layout.leg_ctrl[i]] += laws.own[i]
        laws.applied[platform + i] = laws.own[9 + i]
    for j in range(3):
        laws.applied[arm[j]] = laws.own[6 + j]


@compiled
def read_laws(time: float, laws: RigLaws, row: FloatArray, logged: bool) -> None:
    """Change a row (WIDTH,) as laws of readings have it; after `look`.

    Args:
        time: of the row [s].
        laws: of the plant.
        row: signals of this instant.
        logged: whether the row is a recorder's; else that of the board, where the computers read
            the force sensor.
    """
    read = laws.readings
    for n in range(len(read.codes)):
        memory, shape, at = read.memory[n], read.codes[n, SHAPE], read.codes[n, DOF]
        told = shape <= MESH and WRENCH <= at < WRENCH_END
        if told == logged:
            continue
        first = read.values[read.codes[n, FIRST_VALUE]]
        if shape == PLAY:
            half = 0.5 * first
            last = row[at] if np.isnan(memory[SLIDER]) else memory[SLIDER]
            memory[SLIDER] = min(max(last, row[at] - half), row[at] + half)
            row[at] = memory[SLIDER]
        elif shape == HOLD:
            if memory[ASKED] % max(np.rint(first), 1.0) == 0.0:
                memory[SLIDER] = row[at]
            memory[ASKED] += 1.0
            row[at] = memory[SLIDER]
        else:
            row[at] += law_value(time, laws.position, laws.speed, laws.command, read, n)
