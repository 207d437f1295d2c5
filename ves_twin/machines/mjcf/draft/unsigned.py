"""words_of_unsigned: efforts that are logged without their direction, of joints that turn back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.machines.mjcf.draft.effort_fit import MOST, TURNS, EffortFit
from ves_twin.machines.mjcf.draft.judge import GAINED, Judge
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.motion import Motion
from ves_twin.machines.mjcf.draft.names import is_command

NONE = 0.02
"""Share of its largest size that such a column may go below zero: the zero of a sensor."""

NEAR_ZERO, REST = 5.0, 0.2
"""Percentile of a column, and share of its largest size that it comes down to where its joint rests
or turns: assumed."""

LESS = 0.5
"""Share of what is left of a measured effort that its signed twin may leave: of a load that hardly
changes the sign of the motion makes a dry friction. A command stays near its dead band, too, and of
that the model says whether there is a load."""


def words_of_unsigned(judge: Judge, found: Sequence[Match], motion: Motion) -> list[str]:
    """A sentence for each effort that friction and model explain with the sign of its motion alone.

    A bridge driver takes a duty and a direction, and a log that keeps the first has no sign. A
    weight asks for one sign, too, whichever way it moves, and fits no better with the motion's.

    Args:
        judge: of the columns.
        found: columns as they are meant.
        motion: along the log.
    """
    said = []
    for match in judge.driving(list(found)):
        y = judge.log.as_logged(match.column)
        low, most = np.percentile(y, (NEAR_ZERO, 100.0 - NEAR_ZERO))
        if np.min(y) < -NONE * np.max(y) or low > REST * most:  # a pulse about its middle has none
            continue
        rows, speed = judge.recorded(match, motion), motion.speed[:, judge.dof(match)]
        if min(np.mean(speed > 0.0), np.mean(speed < 0.0)) < TURNS:
            continue
        need = judge.needed(match, motion)
        turned = np.abs(rows) * np.sign(speed)
        now, then = (EffortFit.of(y, need, speed, match.indirect).share for y in (rows, turned))
        left, rest = (1.0 - now) * np.var(rows), (1.0 - then) * np.var(turned)
        put_out = is_command(judge.log.said.get(match.column, match.column))
        sure = np.std(need) > abs(np.mean(need)) if put_out else rest < LESS * left
        if then > max(now + GAINED, MOST) and sure:
            said.append(
                f"{match.column} is never below zero, though {match.spot.joint} moves both ways:"
                f" with the sign of the motion model and friction explain {then:.0%} of it,"
                f" {now:.0%} as logged. Is its direction in another column? Write the product of"
                " both"
            )
    return said
