"""Motion: what position mode follows, as a table: sines, multisines, way points, set-points."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ves_twin.control.multisine import Multisine, multisine
from ves_twin.control.waypoints import Waypoint, Waypoints
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import PlatformMotion, Sine
from ves_twin.scenario.fields import ZERO_POSE, Hertz, Part, Pose, Seconds, si


class SineMotion(Part):
    """Sines about the start pose, one an axis, faded in."""

    kind: Literal["sine"]
    amplitude: Pose
    frequency: Annotated[tuple[Hertz, ...], Field(min_length=6, max_length=6)]
    phase: Annotated[tuple[Annotated[float, si("rad")], ...], Field(min_length=6, max_length=6)] = (
        ZERO_POSE
    )
    fade: Annotated[Seconds, Field(ge=0)] = 1.0

    def build(self, start: FloatArray) -> PlatformMotion:
        """The motion about a start pose (6,)."""
        return Sine(
            at=start,
            amplitude=np.array(self.amplitude),
            frequency=np.array(self.frequency),
            phase=np.array(self.phase),
            fade=self.fade,
        )


class MultisineMotion(Part):
    """Many sines at once, every axis on lines of its own, so that their answers do not mix.

    The lines of axis a are k / period with k = a modulo 6 inside the band; their amplitudes fall
    with the frequency, so that all have the same speed. `amplitude` is the peak of an axis.
    """

    kind: Literal["multisine"]
    amplitude: Pose
    band: tuple[Hertz, Hertz]
    period: Annotated[Seconds, Field(gt=0)]
    fade: Annotated[Seconds, Field(ge=0)] = 1.0

    @model_validator(mode="after")
    def _every_axis_has_a_line(self) -> Self:
        low, high = self.band
        if not 0.0 < low < high or (high - low) * self.period < 6.0:
            raise ValueError(
                f"platform.motion.band: got {low:g} to {high:g} Hz, expected a band that holds"
                f" six lines of {1.0 / self.period:g} Hz"
            )
        return self

    def build(self, start: FloatArray) -> Multisine:
        """The motion about a start pose (6,)."""
        return multisine(start, np.array(self.amplitude), self.band, self.period, self.fade)


class WaypointPart(Part):
    """One quintic platform move."""

    start: Annotated[Seconds, Field(ge=0)]
    duration: Annotated[Seconds, Field(gt=0)]
    to: Pose


class WaypointMotion(Part):
    """Quintic moves from pose to pose, standing between them."""

    kind: Literal["waypoints"]
    moves: Annotated[tuple[WaypointPart, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _moves_follow_each_other(self) -> Self:
        for one, two in zip(self.moves, self.moves[1:], strict=False):
            if two.start < one.start + one.duration - 1e-9:  # round-off of a sum of times
                raise ValueError(
                    f"platform.motion.moves: the move at {two.start} s starts before the one at"
                    f" {one.start} s has ended"
                )
        return self

    def build(self, start: FloatArray) -> Waypoints:
        """The motion from a start pose (6,)."""
        moves = tuple(Waypoint(m.start, m.duration, np.array(m.to)) for m in self.moves)
        return Waypoints(start, moves)


class SetpointMotion(Part):
    """Set-points of a file, as `ves-twin diagnose` proposes them: leg lengths, and the arm's.

    `file` is a name of scenarios/data/, or a .csv or .parquet file, looked for beside the
    scenario's own file first. Its columns are t [s], leg.command.1 ... 6 [m] and
    arm.command.1 ... 3 [rad]; without the latter the arm does what [arm] says.
    """

    kind: Literal["setpoints"]
    file: str


Motion = SineMotion | MultisineMotion | WaypointMotion | SetpointMotion
