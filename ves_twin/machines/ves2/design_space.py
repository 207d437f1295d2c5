"""Ves2DesignSpace: multisines of the platform with moves of the arm, as points of a box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.excitations import SPEED_SHARE, carried_out
from ves_twin.machines.ves2.forward import DRIVE
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.plant import Plant
from ves_twin.scenario.motions import MultisineMotion
from ves_twin.scenario.schema import Scenario

BASE = "identify_fast"
"""Scenario whose motion is replaced."""

FARTHEST = np.array([0.12, 0.12, 0.12, *np.deg2rad([10.0, 10.0, 14.0])])
"""Largest peak of an axis [m, rad], about 2.4 times that of BASE; rod speed binds before it."""

LOWEST, HIGHEST = (0.1, 0.6), (1.5, 6.0)
"""Ranges of the band's ends [Hz]: the legs' loops pass 2 Hz, what shakes the frame is above."""

LEAST, MOST = 3.0, 60.0
"""Lengths [s]: sines must grow, and each axis must have a line; a long one takes too many runs."""

FADE = 1.0
"""Time over which the sines grow [s]."""

ARM = np.deg2rad([[-70.0, 150.0], [10.0, 95.0], [-80.0, 60.0]])
"""Joint angles [rad] that the programmes of the menu reach."""

ARM_SPEED = np.deg2rad(105.0)
"""Highest joint speed of the menu's programmes [rad/s]."""

ARM_MOVE = 2.4
"""Duration of a move of the arm, or a little more [s]."""

BEGIN = 0.1
"""Time before the arm moves, and after it [s]."""

QUINTIC = 1.875
"""Highest speed of a quintic move, in distance over duration."""

SHORT = 0.95
"""Share of the legs' travel and speed that the geometry is fitted to: the run has the last word."""

SHRINK = 0.8
"""Motion is made smaller by this until sensor range and joint torques are kept, too."""

TRIES = 4


@dataclass(frozen=True)
class Ves2DesignSpace:
    """Peaks of six axes and a band, and where the arm goes.

    Attributes:
        plant: the nominal rig.
        scenario: rates and leg settings.
        seconds: how long it lasts.
    """

    plant: Plant
    scenario: Scenario
    seconds: float

    @property
    def size(self) -> int:
        """Numbers of a point: six peaks, two ends of the band, three angles of each arm move."""
        return 8 + 3 * self._moves

    @property
    def _moves(self) -> int:
        return max(1, int((self.seconds - 2.0 * BEGIN) / ARM_MOVE))

    def excitation(self, point: FloatArray, name: str) -> Excitation | None:
        """Set-points of a point in [-1, 1] (size,); None if the rig carries them out at no size."""
        peaks = 0.5 * (point[:6] + 1.0) * FARTHEST
        band = [
            float(np.exp(np.interp(x, (-1.0, 1.0), np.log(ends))))
            for x, ends in zip(point[6:8], (LOWEST, HIGHEST), strict=True)
        ]
        peaks = peaks * self._fitting(peaks, band)
        for k in range(TRIES):
            motion = self._motion(SHRINK**k * peaks, band)
            changes = {
                "run.duration": self.seconds,
                "platform.motion": motion.model_dump(mode="json"),
                "arm.moves": self._arm(SHRINK**k * point[8:].reshape(-1, 3)),
            }
            run = carried_out(self.plant, self.scenario, BASE, changes)
            most = self.plant.parameters.array("arm.torque_limit")
            if run is not None and np.all(np.abs(run["arm.torque"]) < most):
                return Excitation.of(run, DRIVE, name)
        return None

    def _motion(self, peaks: FloatArray, band: list[float]) -> MultisineMotion:
        return MultisineMotion(
            kind="multisine",
            amplitude=tuple(map(float, peaks)),
            band=(band[0], band[1]),
            period=2.0 * self.seconds,
            fade=FADE,
        )

    def _fitting(self, peaks: FloatArray, band: list[float]) -> float:
        """Share of the peaks at which legs keep travel and speed: both grow with the peaks."""
        number, array = self.plant.parameters.number, self.plant.parameters.array
        travel = number("leg.stroke") / 2.0 - number("leg.margin")
        fastest = SPEED_SHARE * float(np.min(array("hydraulics.full_speed")))
        time = np.arange(0.0, self.seconds, 0.01)
        share = 1.0
        for _ in range(TRIES):
            motion = self._motion(share * peaks, band).build(np.zeros(6))
            lengths = _lengths(self.plant.geometry, np.array([motion.pose(t) for t in time]))
            taken = max(
                float(np.max(np.abs(lengths - lengths[0]))) / travel,
                float(np.max(np.abs(np.gradient(lengths, time, axis=0)))) / fastest,
            )
            if taken <= 1.0:
                break
            share *= SHORT / taken
        return share

    def _arm(self, shares: FloatArray) -> list[dict[str, object]]:
        """Moves within ARM and ARM_SPEED from the start of BASE on."""
        here, moves = np.array(Scenario.load(BASE).arm.start), []
        duration = (self.seconds - 2.0 * BEGIN) / len(shares)
        most = ARM_SPEED * duration / QUINTIC
        for k, share in enumerate(shares):
            wanted = ARM.mean(axis=1) + 0.5 * np.diff(ARM, axis=1)[:, 0] * share
            here = here + np.clip(wanted - here, -most, most)
            start = BEGIN + k * duration
            moves.append({"start": start, "duration": duration, "to": here.tolist()})
        return moves


def _lengths(geometry: StewartGeometry, poses: FloatArray) -> FloatArray:
    """Leg lengths [m] (n, 6) of poses (n, 6)."""
    return np.array([geometry.lengths(pose) for pose in poses])
