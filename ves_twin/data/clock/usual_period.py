"""is_usual: whether rows of a machine's log are as far apart as laboratories have them."""

from __future__ import annotations

USUAL = (1e-5, 0.5)
"""Time between rows of a machine's log [s], beyond which its clock may be in another unit."""


def is_usual(period: float) -> bool:
    """Whether rows of a laboratory's log are that far apart [s]."""
    return USUAL[0] <= period <= USUAL[1]
