"""timed_path: joint angles cycle by cycle along a path, smooth from rest to rest."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import quintic
from ves_twin.mechanics.path_motion import at_lengths, path_lengths

POINTS = 401
"""Points of a rounded path: under a degree apart for any move of this arm."""

SMOOTHING = 16.0
"""Corners are rounded over this many points, one sd: 4 % of the way; no joint rate jumps."""


def timed_path(corners: FloatArray, seconds: float, cycle: float, rest: float) -> FloatArray:
    """Commands along a polyline of joint angles: a quintic in its length, then rest at its end.

    Args:
        corners: joint angles [rad] (k, n).
        seconds: duration of the motion [s].
        cycle: time between commands [s].
        rest: time at the end [s].

    Returns:
        Joint angles at 0, cycle, 2 cycle ... [rad] (m, n).

    Raises:
        InvalidInputError: no length, or no time for it.
    """
    if not (seconds > 0 and cycle > 0 and rest >= 0):
        raise InvalidInputError("path timing", (seconds, cycle, rest), "times above zero")
    corners = np.asarray(corners, float)
    lengths = path_lengths(corners)
    if not lengths[-1] > 0:
        raise InvalidInputError("path", corners.tolist(), "two different configurations")
    count = round((seconds + rest) / cycle) + 1
    share = np.array([quintic(k * cycle / seconds) for k in range(count)])
    return at_lengths(corners, lengths, share * lengths[-1])


def evenly(corners: FloatArray, count: int) -> FloatArray:
    """A polyline (k, n) at places evenly spaced along it (count, n)."""
    corners = np.asarray(corners, float)
    lengths = path_lengths(corners)
    return at_lengths(corners, lengths, np.linspace(0.0, lengths[-1], count))


def rounded(corners: FloatArray) -> FloatArray:
    """A polyline (k, n) with rounded corners, evenly spaced (401, n), its ends kept.

    What the way deviates from the straight one is blurred by a Gaussian.
    """
    corners = np.asarray(corners, float)
    path = evenly(corners, POINTS)
    straight = path[0] + np.linspace(0.0, 1.0, POINTS)[:, None] * (path[-1] - path[0])
    bulge = path - straight
    mirrored = np.concatenate([-bulge[:0:-1], bulge, -bulge[-2::-1]])  # odd, so the ends stay
    blurred = gaussian_filter1d(mirrored, SMOOTHING, axis=0)[POINTS - 1 : 2 * POINTS - 1]
    smooth = evenly(straight + blurred, POINTS)
    smooth[0], smooth[-1] = corners[0], corners[-1]
    return smooth
