"""State: the states of the platform's control program, and what the program commands in each."""

from __future__ import annotations

from enum import StrEnum


class State(StrEnum):
    """Where the machine stands (thesis Appendix E).

    OFF: no power in the crate. SLEEP: legs retracted, program not running. START: loops closed at
    the lengths that the legs have, watched. IDLE: held. HOME: on the ramp to home, or held there.
    RUN: the scenario's mode. FREEZE: valves without current, program stopped.
    """

    OFF = "off"
    SLEEP = "sleep"
    START = "start"
    IDLE = "idle"
    HOME = "home"
    RUN = "run"
    FREEZE = "freeze"


ACTIVE = frozenset({State.START, State.IDLE, State.HOME, State.RUN})
"""The program runs: legs under control, manifold pressure watched."""


class Task(StrEnum):
    """What the Redslave commands in a cycle."""

    NOTHING = "nothing"
    HOLD = "hold"
    TO_HOME = "to_home"
    TO_SLEEP = "to_sleep"
    RUN = "run"


class Action(StrEnum):
    """What an operator can do, at a button or at a terminal."""

    PRESS_PANIC = "press_panic"
    RELEASE_PANIC = "release_panic"
    START_PUMP = "start_pump"
    STOP_PUMP = "stop_pump"
    CRATE_OFF = "crate_off"
    CRATE_ON = "crate_on"
    PRESS_ARM_PANIC = "press_arm_panic"
    RELEASE_ARM_PANIC = "release_arm_panic"
    SET_ACTIVE_FLAG = "set_active_flag"
    CLEAR_ACTIVE_FLAG = "clear_active_flag"
    READ_SENSOR = "read_sensor"
    START_PLATFORM = "start_platform"
    IDLE = "idle"
    HOME = "home"
    RUN = "run"
    SLEEP = "sleep"
