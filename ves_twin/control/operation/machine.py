"""Machine: the laboratory as a state machine: buttons, switches, programs, and their rules.

It knows no rig: `act` and `watch` are told what the machine can see, and `task`, `legs_powered`,
`arm_driven` and `arm_braked` say what follows for the rig.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

from ves_twin.control.operation.state import ACTIVE, Action, State, Task


@dataclass(frozen=True)
class Note:
    """Something that happened, for the log of the run: kind and one clear line."""

    kind: str
    message: str


@dataclass(frozen=True)
class Sight:
    """What the machine can see at an interrupt.

    Attributes:
        pressure: reading of the manifold gauge [Pa].
        low_pressure: reading below which it counts as low [Pa].
        arm_in_place: whether the arm is where the motion controller would command it.
        low_platform: whether the legs are retracted as in sleep.
        arrived: whether the ramp that was asked for has ended.
    """

    pressure: float
    low_pressure: float
    arm_in_place: bool = True
    low_platform: bool = False
    arrived: bool = False


@dataclass
class Machine:
    """Buttons, switches and programs; see `State` for the states.

    Attributes:
        state: where the platform's program stands.
        crate: power of the crate: Redslave, Blueslave, motion controller, amplifiers.
        panic: the platform's panic button is pressed.
        pump: the pump runs.
        arm_panic: the arm's panic button is pressed: drives off, brakes on.
        arm_program: the motion controller commands the joints.
        flag: platActive: the Blueslave takes forces from shared memory.
        locked: both computers have locked up.
        task: what the Redslave commands.
        until: when the watch of a start ends [s].
        then: what follows when a ramp to home has ended.
    """

    state: State
    crate: bool = True
    panic: bool = False
    pump: bool = True
    arm_panic: bool = False
    arm_program: bool = True
    flag: bool = True
    locked: bool = False
    task: Task = Task.RUN
    until: float = 0.0
    then: Task = Task.HOLD

    @staticmethod
    def at(state: State) -> Machine:
        """A machine that stands in a state as the handbook leaves it there."""
        if state is State.OFF:
            return Machine(
                state, crate=False, panic=True, pump=False, arm_panic=True, arm_program=False,
                flag=False, task=Task.NOTHING,
            )  # fmt: skip
        if state is State.SLEEP:
            return Machine(state, panic=True, pump=False, flag=False, task=Task.NOTHING)
        if state is State.FREEZE:
            return Machine(state, panic=True, task=Task.NOTHING)
        return Machine(state, task=Task.RUN if state is State.RUN else Task.HOLD)

    @property
    def legs_powered(self) -> bool:
        """Whether currents reach the valves; without them the spools go to null."""
        return self.state in ACTIVE

    @property
    def arm_driven(self) -> bool:
        """Whether the motion controller drives the joints."""
        return self.crate and self.arm_program and not self.arm_panic

    @property
    def arm_braked(self) -> bool:
        """Whether the brakes hold the joints; neither driven nor braked, the arm falls."""
        return self.arm_panic

    def copy(self) -> Machine:
        """A copy."""
        return copy(self)

    def act(self, action: Action, time: float, sight: Sight, watch: float) -> list[Note]:
        """Carry out what an operator does; what the machine refuses is a note that says why.

        Args:
            action: what is done.
            time: when [s].
            sight: what the machine can see.
            watch: how long a start is watched [s].
        """
        if action in _BUTTONS:
            return _BUTTONS[action](self)
        if action is Action.CRATE_ON:
            return self._boot(sight)
        if action is Action.RELEASE_ARM_PANIC:
            return self._release_arm(sight)
        why = self._why_not(action, sight)
        if why:
            return [Note("refused", f"{action}: {why}")]
        if action is Action.START_PLATFORM:
            self.until = time + watch
            self.task = Task.HOLD
            return self._to(State.START, "loops closed at the lengths that the legs have")
        return self._move(action)

    def watch(self, time: float, sight: Sight) -> list[Note]:
        """What the machine does of itself at an interrupt: end of a start, a ramp, a pressure."""
        if self.state not in ACTIVE or self.locked:
            return []
        if sight.pressure < sight.low_pressure:
            bar = f"{sight.pressure / 1e5:.0f} bar"
            return self.freeze(f"manifold pressure {bar} is below {sight.low_pressure / 1e5:.0f}")
        if self.state is State.START and time >= self.until:
            return self._to(State.IDLE, "the platform is under control")
        if self.task is Task.TO_HOME and sight.arrived:
            return self._at_home()
        if self.task is Task.TO_SLEEP and sight.arrived:
            self.task = Task.NOTHING
            return self._to(State.SLEEP, "legs retracted, program ended")
        return []

    def freeze(self, why: str) -> list[Note]:
        """Valves without current, program stopped; nothing where no program runs."""
        if self.state not in ACTIVE:
            return []
        self.task = Task.NOTHING
        return self._to(State.FREEZE, why)

    def _why_not(self, action: Action, sight: Sight) -> str:
        """Why the computers refuse a command, or an empty text."""
        if not self.crate:
            return "the crate has no power"
        if self.locked:
            return "the computers do not answer; press the arm's panic button and reboot the crate"
        if action is Action.START_PLATFORM:
            if self.state in ACTIVE:
                return "the platform runs already"
            low = "the pressure is too low" if sight.pressure < sight.low_pressure else ""
            pressed = "the panic button is pressed" if self.panic else ""
            return " and ".join(filter(None, (low, pressed)))
        if self.state not in ACTIVE:
            return f"the platform's program does not run (state {self.state})"
        return "the start is not over" if self.state is State.START else ""

    def _move(self, action: Action) -> list[Note]:
        if action is Action.IDLE:
            self.task = Task.HOLD
            return self._to(State.IDLE, "held where it is")
        if action is Action.RUN and self.state is State.HOME and self.task is Task.HOLD:
            self.task = Task.RUN
            return self._to(State.RUN, "the scenario's mode takes over")
        followers = {Action.RUN: Task.RUN, Action.SLEEP: Task.TO_SLEEP}
        self.task, self.then = Task.TO_HOME, followers.get(action, Task.HOLD)
        return self._to(State.HOME, "ramp to home")

    def _at_home(self) -> list[Note]:
        self.task = self.then
        if self.task is Task.RUN:
            return self._to(State.RUN, "the scenario's mode takes over")
        what = "ramp to sleep" if self.task is Task.TO_SLEEP else "at home"
        return [Note("operation", what)]

    def _boot(self, sight: Sight) -> list[Note]:
        if self.crate:
            return [Note("refused", "crate_on: the crate has power")]
        self.crate, self.locked, self.flag = True, False, False
        self.arm_program = False
        state = State.SLEEP if sight.low_platform else State.FREEZE
        return self._to(state, "crate booted, no program runs")

    def _release_arm(self, sight: Sight) -> list[Note]:
        if self.arm_panic and self.crate and not sight.arm_in_place:
            return [Note("refused", "release_arm_panic: the arm is not where it is commanded")]
        self.arm_panic = False
        self.arm_program = self.crate
        return [*_FALL] if not self.crate else [Note("operation", "the arm is driven")]

    def press_panic(self) -> list[Note]:
        """Freeze the platform."""
        self.panic = True
        return self.freeze("panic button pressed") or [Note("operation", "panic button pressed")]

    def release_panic(self) -> list[Note]:
        """Let a start be possible; nothing moves by it."""
        self.panic = False
        return [Note("operation", "panic button released")]

    def switch_pump(self, on: bool) -> list[Note]:
        """Start or stop the pump."""
        self.pump = on
        return [Note("operation", f"pump {'started' if on else 'stopped'}")]

    def crate_off(self) -> list[Note]:
        """Cut the crate's power: valves without current, and the arm without its controller."""
        if not self.crate:
            return [Note("refused", "crate_off: the crate has no power")]
        self.crate, self.locked, self.task = False, False, Task.NOTHING
        notes = self._to(State.OFF, "crate power cut")
        return notes if self.arm_panic else [*notes, *_FALL]

    def press_arm_panic(self) -> list[Note]:
        """Drives off, brakes on."""
        self.arm_panic = True
        return [Note("operation", "arm's panic button pressed, brakes on")]

    def set_flag(self, on: bool) -> list[Note]:
        """Tell the Blueslave whether the platform runs and passes on forces."""
        if not self.crate or self.locked:
            return [Note("refused", "active flag: the Blueslave does not answer")]
        self.flag = on
        return [Note("operation", f"active flag {'set' if on else 'cleared'}")]

    def read_sensor(self) -> list[Note]:
        """A routine of the Blueslave that reads the force sensor."""
        if not self.crate or self.locked:
            return [Note("refused", "read_sensor: the Blueslave does not answer")]
        if self.flag or self.state not in ACTIVE:
            source = "shared memory" if self.flag else "the A/D board"
            return [Note("operation", f"the Blueslave reads the force sensor from {source}")]
        self.locked = True
        return [Note("lock_up", "both computers read the A/D board and have locked up")]

    def _to(self, state: State, why: str) -> list[Note]:
        before, self.state = self.state, state
        return [Note("operation", f"{before} -> {state}: {why}")]


_FALL = (Note("arm_falls", "the arm has neither drive nor brake"),)

_BUTTONS: dict[Action, Callable[[Machine], list[Note]]] = {
    Action.PRESS_PANIC: Machine.press_panic,
    Action.RELEASE_PANIC: Machine.release_panic,
    Action.START_PUMP: lambda machine: machine.switch_pump(True),
    Action.STOP_PUMP: lambda machine: machine.switch_pump(False),
    Action.CRATE_OFF: Machine.crate_off,
    Action.PRESS_ARM_PANIC: Machine.press_arm_panic,
    Action.SET_ACTIVE_FLAG: lambda machine: machine.set_flag(True),
    Action.CLEAR_ACTIVE_FLAG: lambda machine: machine.set_flag(False),
    Action.READ_SENSOR: Machine.read_sensor,
}
"""What works whatever the programs do."""
