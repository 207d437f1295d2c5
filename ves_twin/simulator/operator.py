"""Operator: the operators' script, the laboratory's state machine, and the cycle that follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.operation.machine import Machine, Note, Sight
from ves_twin.control.operation.ramp import Ramp
from ves_twin.control.operation.state import State, Task
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.recording.recording import Event
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.rotations import matrix_from_quaternion
from ves_twin.plant.laboratory import Laboratory
from ves_twin.scenario.operation_part import Operation
from ves_twin.simulator.computers import Computers
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.switches import Switches, SwitchesSnapshot

AT_SLEEP = 0.01
"""How far a leg may be from its length in sleep and the platform still count as low [m]."""


@dataclass(frozen=True)
class OperatorSnapshot(ReadOnly):
    """What changes from cycle to cycle."""

    machine: Machine
    done: int
    held: FloatArray
    ramp: Ramp | None
    since: float
    switches: SwitchesSnapshot


class Operator:
    """What happens at an interrupt where a scenario has an operation.

    Attributes:
        machine: the laboratory's state machine.

    Args:
        operation: the script.
        rig: the rig, built.
        computers: the admittance cycle.
        belief: what the computers take the rig to be.
        start: pose of home and of the scenario's mode [m, rad] (6,).
        played: set-points are played back; then the machine commands no pose of its own.
    """

    def __init__(
        self,
        operation: Operation,
        rig: Rig,
        computers: Computers,
        belief: Belief,
        start: FloatArray,
        played: bool,
    ) -> None:
        self._actions = operation.actions
        self._laboratory = Laboratory.load()
        self._rig, self._computers, self._geometry = rig, computers, belief.geometry
        self._home_lengths = belief.geometry.lengths(np.zeros(6))
        self._sleep = belief.geometry.pose(self._home_lengths - self._laboratory.sleep_travel)
        self._start, self._played = start, played
        self._period = rig.clock.admittance * rig.clock.tick
        self._fresh = computers.controller.snapshot()
        self._switches = Switches(rig, self._laboratory)
        self.machine = Machine.at(operation.begin)
        low = operation.begin in (State.OFF, State.SLEEP)
        self._held = (self._sleep if low and not played else start).copy()
        self._done, self._since = 0, 0.0
        self._ramp: Ramp | None = None

    @property
    def standing(self) -> FloatArray:
        """Pose at which the run begins [m, rad] (6,)."""
        return self._held.copy()

    def begin(self) -> list[Event]:
        """Let the state that the run begins in take effect, after settling."""
        self._switches.begin(self.machine)
        self._switches.set(self.machine)
        return [Event(0.0, "operation", f"begins in {self.machine.state}")]

    def cycle(self, tick: int, time: float, late: str) -> tuple[list[Event], str]:
        """One interrupt: actions that are due, what the machine does of itself, set-points.

        Args:
            tick: tick of the interrupt.
            time: its time [s].
            late: why the cycle before has not ended, or an empty text.

        Returns:
            What happened, and what ends the run: an empty text, or how the arm hit the ceiling.

        Raises:
            ControllerError: as `Computers.cycle`.
        """
        notes: list[Note] = []
        for step in (self._act, self._watch):
            before = self.machine.state, self.machine.task
            notes += step(time, late)
            if (self.machine.state, self.machine.task) != before:
                self._take_up(time)
        self._switches.pump_on(self.machine.pump, self._period)
        notes += self._command(tick, time)
        self._switches.set(self.machine)
        return [Event(time, note.kind, note.message) for note in notes], self._ceiling()

    def snapshot(self) -> OperatorSnapshot:
        """A copy of everything that the next cycle depends on."""
        return OperatorSnapshot(
            self.machine.copy(),
            self._done,
            self._held.copy(),
            self._ramp,
            self._since,
            self._switches.snapshot(),
        )

    def restore(self, snapshot: OperatorSnapshot) -> None:
        """Go back to a snapshot."""
        self.machine = snapshot.machine.copy()
        self._done, self._since = snapshot.done, snapshot.since
        self._held, self._ramp = snapshot.held.copy(), snapshot.ramp
        self._switches.restore(snapshot.switches, self.machine)

    def _act(self, time: float, _: str) -> list[Note]:
        notes: list[Note] = []
        while self._done < len(self._actions) and self._actions[self._done].at <= time:
            action = self._actions[self._done].action
            self._done += 1
            notes += self.machine.act(action, time, self._see(time), self._laboratory.watch)
        return notes

    def _watch(self, time: float, late: str) -> list[Note]:
        notes = self.machine.watch(time, self._see(time))
        if late and self.machine.state is State.RUN and not self.machine.locked:
            notes += self.machine.freeze(f"overrun: {late}")
        return notes

    def _see(self, time: float) -> Sight:
        board = self._rig.board
        command = self._rig.state["servo"]["points"][0, 2]
        asleep = self._home_lengths - self._laboratory.sleep_travel
        return Sight(
            pressure=float(board["supply.pressure"][0]),
            low_pressure=self._laboratory.low_pressure,
            arm_in_place=bool(np.all(np.abs(board["arm.q"] - command) < self._laboratory.near)),
            low_platform=bool(np.all(board["leg.length"] < asleep + AT_SLEEP)),
            arrived=self._ramp is not None and self._ramp.ended(time),
        )

    def _take_up(self, time: float) -> None:
        """Begin what the machine's new state asks for."""
        machine = self.machine
        self._ramp = None
        if machine.state is State.START:
            self._held = self._geometry.pose(self._switches.close_loops(), self._held)
        elif machine.task in (Task.TO_HOME, Task.TO_SLEEP):
            there = self._start if machine.task is Task.TO_HOME else self._sleep
            speed = self._laboratory.ramp_speed
            self._ramp = Ramp.between(self._held, there, time, speed, self._geometry)
        elif machine.task is Task.RUN:
            self._computers.controller.restore(self._fresh)
            self._since = time

    def _command(self, tick: int, time: float) -> list[Note]:
        """Send the set-points of this cycle, where there is a computer that sends any."""
        machine, computers = self.machine, self._computers
        if machine.locked or not machine.crate:
            self._hold_arm(tick)
            return []
        if machine.task is Task.RUN or self._played:
            outside = computers.cycle(tick, time, self._since)
            self._held = self._rig.board["platform.command"].copy()
        else:
            if self._ramp is not None:
                self._held = self._ramp.pose(time)
            computers.estimate_gravity(time)
            outside = computers.send(tick, time, self._held)
        if not outside:
            return []
        self._hold_arm(tick)
        return machine.freeze(f"the command of leg {outside} left the safety margin; not sent")

    def _hold_arm(self, tick: int) -> None:
        """The motion controller goes on with the last command that it has."""
        points = self._rig.state["servo"]["points"][0]
        points[:3] = points[1:].copy()
        self._rig.state["cycle_start"] = tick

    def _ceiling(self) -> str:
        """How the arm hits the ceiling, or an empty text."""
        rig, layout = self._rig, self._rig.layout
        at = layout.platform_qpos
        up = matrix_from_quaternion(rig.data.qpos[at + 3 : at + 7])[2]
        q = rig.data.qpos[layout.arm_qpos]
        rise = rig.data.qpos[at + 2] - rig.plant.geometry.home[2]
        height = rise + float(np.max(rig.plant.arm.transforms(q)[:, :3, 3] @ up))
        if height <= self._laboratory.ceiling:
            return ""
        return f"the arm reached {height:.3f} m, the ceiling is at {self._laboratory.ceiling:.3f} m"
