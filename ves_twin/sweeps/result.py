"""PointResult: what came out of one point of a sweep."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ves_twin.scenario.fields import Part

REFUSED = "refused"
"""The run could not be built or a controller failed; the reason is the message."""

ERROR = "error"
"""The program failed on this point; the reason names the exception."""

LOST = "lost"
"""The worker died with it every time; it is tried again when the sweep is started again."""


class AxisResult(Part):
    """Emulation error of one axis [m or rad]; `relative` is the peak's share of the motion."""

    rms: float
    peak: float
    relative: float | None
    rms_rest: float


class TrackingResult(Part):
    """Tracking error of one axis [m or rad], where nothing is emulated."""

    rms: float
    peak: float
    relative: float | None


class PointResult(Part):
    """One finished point.

    `outcome` is that of the run, or REFUSED, ERROR, LOST. `run_hash` is a hash over every
    recorded number; it and all but `seconds` and `host` are the same wherever the point ran.
    """

    number: Annotated[int, Field(ge=0)]
    run_id: str
    outcome: str
    reason: str = ""
    duration: float = 0.0
    emulation_error: dict[str, AxisResult] = Field(default_factory=dict)
    tracking_error: dict[str, TrackingResult] = Field(default_factory=dict)
    run_hash: str = ""
    seconds: float = 0.0
    host: str = ""
