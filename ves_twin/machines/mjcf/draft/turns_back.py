"""words_of_one_way: joints that move one way alone, where friction and a constant look alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ves_twin.machines.mjcf.draft.motion import Motion

FAST = 0.1
"""Share of a joint's largest speed above which its direction counts."""

BACK = 0.02
"""Share of such rows that go the other way up to which a joint does not turn back."""


def words_of_one_way(motion: Motion, dofs: Mapping[str, int], driven: Sequence[str]) -> list[str]:
    """A sentence of joints that never turn back; none where all do.

    Args:
        motion: along the log.
        dofs: joint -> its degree of freedom.
        driven: joints whose effort was recorded.
    """
    alone = [joint for joint in driven if _one_way(motion, dofs[joint])]
    if not alone:
        return []
    verb = "moves" if len(alone) == 1 else "move"
    return [
        f"{', '.join(alone)} {verb} one way alone: dry friction and an offset look alike there. A"
        " log that goes to and fro tells them apart"
    ]


def _one_way(motion: Motion, dof: int) -> bool:
    speed = motion.speed[:, dof]
    fast = speed[np.abs(speed) > FAST * np.max(np.abs(speed), initial=0.0)]
    return bool(len(fast) and min(np.mean(fast > 0.0), np.mean(fast < 0.0)) < BACK)
