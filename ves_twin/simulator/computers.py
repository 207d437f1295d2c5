"""Computers: one admittance cycle, from the clock interrupt to the set-points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ves_twin.control import gravity_law, platform_law
from ves_twin.control.belief import Belief
from ves_twin.control.controller import PlatformController
from ves_twin.control.gravity import GravityCompensation
from ves_twin.control.gravity_feedforward import GravityFeedforward
from ves_twin.control.law_of import law_of
from ves_twin.control.readings import Readings
from ves_twin.control.safety import NOT_A_POSE
from ves_twin.core.errors import ControllerError, VesTwinError, one_line
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.joint_motion import JointMotion
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.cycles import AHEAD, pass_on
from ves_twin.simulator.setpoints import send_setpoints
from ves_twin.simulator.signal_bus import SignalBus

LONGEST_STRETCH = 32
"""Cycles that run without the interpreter, 0.4 s of the rig: what ctrl-C waits for."""


@dataclass(frozen=True)
class ComputersSnapshot(ReadOnly):
    """What changes from cycle to cycle outside the board and the state block."""

    controller: object
    gravity: object
    shared: tuple[FloatArray, ...]
    feedforward: object


class Computers:
    """The Redslave's and Blueslave's work at one interrupt, in the thesis's order.

    Read forces, take the gravity estimate from shared memory, controller, inverse kinematics,
    safety, set-points to legs and arm (thesis 2.4.2).

    Attributes:
        controller: decides the platform's pose.
        gravity: estimates the gravity wrench.
        points: the arm's commands about this cycle, live [rad] (4, 3).
        readings: what controller and compensation see.
    """

    def __init__(
        self,
        belief: Belief,
        controller: PlatformController,
        gravity: GravityCompensation,
        gravity_age: int,
        arm: JointMotion,
        feedforward: GravityFeedforward | None,
        period: float,
        board: SignalBus,
        state: Block,
    ) -> None:
        self.controller = controller
        self.gravity = gravity
        self._arm = arm
        self._feedforward = feedforward
        self._period = period
        g = self._geometry = belief.geometry
        self._reach = (g.base, g.top, g.home, g.lengths(np.zeros(6)), belief.leg_travel)
        self._shared, self._passed = np.zeros((gravity_age + 1, 6)), np.zeros(1, np.int64)
        self._state, self._board = state, board.block
        self._ahead = np.zeros(LONGEST_STRETCH, AHEAD)
        self.points: FloatArray = state["servo"]["points"][0]
        self._held_torque = state["servo"]["feedforward"][0]
        self._estimate = board["gravity.estimate"]
        self.readings = Readings(
            leg_length=board.read_only("leg.length"),
            wrench_in_sensor=board.read_only("sensor.wrench"),
            gravity_in_sensor=board.read_only("gravity.estimate"),
            arm_q=board.read_only("arm.q"),
            platform_command=board.read_only("platform.command"),
            supply_pressure=board.read_only("supply.pressure"),
        )

    def cycle(self, tick: int, time: float, since: float = 0.0) -> int:
        """One cycle.

        Args:
            tick: tick of the interrupt.
            time: its time [s].
            since: when the platform's controller took over [s].

        Returns:
            0, or the number of the leg whose command would leave its travel; then nothing is sent.

        Raises:
            ControllerError: a controller or compensation raised, or what it gave is not six
                finite numbers.
        """
        self.estimate_gravity(time)
        return self.send(tick, time, self._decide(time - since))

    def compiled(self, first: int, count: int, clock: Clock) -> tuple[Any, ...] | None:
        """What `run_cycles` takes of the computers for coming cycles, or None.

        None where the interpreter is asked in each cycle: a controller or compensation of one's
        own, feed-forward of the arm, what is asked ahead and raises.

        Args:
            first: tick of the first interrupt.
            count: ticks from there on, of at most LONGEST_STRETCH cycles.
            clock: periods.
        """
        platform, gravity = law_of(self.controller), law_of(self.gravity)
        if platform is None or gravity is None or self._feedforward is not None:
            return None
        times = [tick * clock.tick for tick in range(first, first + count, clock.admittance)]
        rows, n = self._ahead, len(times)
        try:
            rows["arm"][:n] = self._arm.along([time + 2.0 * self._period for time in times])
            if platform is platform_law.KNOWN_LAW:
                rows["pose"][:n] = self.controller.ahead(times, self.readings)
            if gravity is gravity_law.KNOWN_LAW:
                rows["wrench"][:n] = self.gravity.ahead(times, self.readings)
        except Exception:  # it raises again in its own cycle, if that comes
            return None
        return rows, platform, gravity, self._shared, self._passed, *self._reach

    def lengths(self, pose: FloatArray) -> FloatArray:
        """Leg lengths [m] (6,) that the computers take a pose (6,) to have."""
        return self._geometry.lengths(pose)

    def estimate_gravity(self, time: float) -> None:
        """A new estimate goes into shared memory; the one of `age` cycles ago comes out.

        Raises:
            ControllerError: a compensation raised, or its estimate is not six finite numbers.
        """
        self._estimate[:] = pass_on(self._shared, self._passed, self._gravity_wrench(time))
        self._passed += 1
        self.hold_arm()

    def hold_arm(self) -> None:
        """The joint servo's feed-forward for this cycle, from the readings of now."""
        if self._feedforward is not None:
            self._held_torque[:] = self._feedforward.torque(self.readings)

    def send(self, tick: int, time: float, pose: FloatArray) -> int:
        """Set-points of a pose to the legs if they are safe, and the arm's command to its spline.

        Returns and raises as `cycle`.
        """
        ahead = self._arm.q(time + 2.0 * self._period)
        code = int(send_setpoints(tick, pose, ahead, *self._reach, self._state, self._board))
        if code == NOT_A_POSE:
            raise self._refusal(pose, time)
        return code

    def start_arm(self, time: float) -> None:
        """Fill the spline's buffer for the cycle that ended at a time."""
        for i in range(4):
            self.points[i] = self._arm.q(time + (i - 2) * self._period)

    def snapshot(self) -> ComputersSnapshot:
        """A copy of everything that the next cycle depends on."""
        passed, size = int(self._passed[0]), len(self._shared)
        ages = range(max(passed - size, 0), passed)
        shared = tuple(self._shared[n % size].copy() for n in ages)
        arm = None if self._feedforward is None else self._feedforward.snapshot()
        return ComputersSnapshot(self.controller.snapshot(), self.gravity.snapshot(), shared, arm)

    def restore(self, snapshot: ComputersSnapshot) -> None:
        """Go back to a snapshot."""
        self.controller.restore(snapshot.controller)
        self.gravity.restore(snapshot.gravity)
        self._passed[0] = len(snapshot.shared)
        for kept, estimate in zip(self._shared, snapshot.shared, strict=False):
            kept[:] = estimate
        if self._feedforward is not None:
            self._feedforward.restore(snapshot.feedforward)

    def _gravity_wrench(self, time: float) -> FloatArray:
        """A copy of the estimate of now: a compensation may use its array again."""
        name = f"gravity compensation {type(self.gravity).__name__}"
        try:
            wrench = self.gravity.wrench(time, self.readings)
        except VesTwinError:
            raise
        except Exception as error:
            raise _raised(name, error, time) from error
        if (
            type(wrench) is not np.ndarray
            or wrench.dtype != np.float64
            or wrench.shape != (6,)
            or not np.isfinite(wrench).all()
        ):
            raise _returned(name, wrench, time, "a wrench")
        return wrench.copy()

    def _decide(self, time: float) -> FloatArray:
        try:
            pose = self.controller.update(time, self.readings)
        except VesTwinError:
            raise
        except Exception as error:
            raise _raised(f"controller {type(self.controller).__name__}", error, time) from error
        if type(pose) is not np.ndarray or pose.dtype != np.float64 or pose.ndim != 1:
            raise self._refusal(pose, time)
        return pose

    def _refusal(self, pose: object, time: float) -> ControllerError:
        return _returned(f"controller {type(self.controller).__name__}", pose, time, "a pose")


def _raised(name: str, error: Exception, time: float) -> ControllerError:
    what = f"{name} raised {type(error).__name__} at t = {time:.3f} s"
    return ControllerError(f"{what}: {one_line(error)}")


def _returned(name: str, came: object, time: float, kind: str) -> ControllerError:
    text = " ".join(repr(came).split())
    return ControllerError(
        f"{name} returned {text} at t = {time:.3f} s, expected {kind} of 6 finite numbers"
    )
