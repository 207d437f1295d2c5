"""offsets_of: constant efforts that a model lacks, where they are more than is usual."""

from __future__ import annotations

from ves_twin.machines.mjcf.draft.effort_fit import carried
from ves_twin.machines.mjcf.draft.estimates import typical
from ves_twin.machines.mjcf.draft.judge import Judge
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.motion import Motion

USUAL = 0.4
"""Share of its typical effort that a constant at a joint may be before its range ends, nearly: half
is usual. Where a log has the swing of a command alone (a rotor about its pulse in rest) it is more.
"""


def offsets_of(judge: Judge, found: list[Match], motion: Motion) -> dict[str, float]:
    """Joint -> constant effort there [N, N m], beyond USUAL, of joints that turn round alone.

    Args:
        judge: of the columns.
        found: columns as they are meant.
        motion: along the log.
    """
    sizes = dict[str, float]()
    for match, effort in judge.along(found, motion):
        if match.indirect:  # its constant is a fit, or none
            continue
        dof = judge.dof(match)
        size = abs(carried(effort - motion.effort[:, dof], motion.speed[:, dof]))
        if size > USUAL * typical(effort):
            sizes[match.spot.joint] = size
    return sizes
