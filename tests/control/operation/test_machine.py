"""Machine: the rules of Appendix E without a rig."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ves_twin.control.operation.machine import Machine, Sight
from ves_twin.control.operation.state import ACTIVE, Action, State, Task

GOOD = Sight(pressure=1e7, low_pressure=7e6)
LOW = Sight(pressure=1e6, low_pressure=7e6)
WATCH = 1.0


def act(machine: Machine, *actions: Action, sight: Sight = GOOD) -> str:
    """Carry out actions; the last message."""
    notes = [note for action in actions for note in machine.act(action, 0.0, sight, WATCH)]
    return notes[-1].message


def test_a_session_goes_through_the_states_in_the_order_of_the_handbook():
    machine = Machine.at(State.SLEEP)
    act(machine, Action.START_PUMP, Action.RELEASE_PANIC, Action.START_PLATFORM)
    assert machine.state is State.START
    assert not machine.watch(0.5, GOOD)
    machine.watch(1.0, GOOD)
    assert machine.state is State.IDLE
    act(machine, Action.HOME)
    assert (machine.state, machine.task) == (State.HOME, Task.TO_HOME)
    machine.watch(2.0, Sight(1e7, 7e6, arrived=True))
    assert (machine.state, machine.task) == (State.HOME, Task.HOLD)
    act(machine, Action.RUN)
    assert machine.state is State.RUN
    act(machine, Action.SLEEP)
    for _ in range(2):
        machine.watch(3.0, Sight(1e7, 7e6, arrived=True))
    assert (machine.state, machine.task) == (State.SLEEP, Task.NOTHING)
    act(machine, Action.PRESS_PANIC, Action.STOP_PUMP, Action.PRESS_ARM_PANIC, Action.CRATE_OFF)
    assert machine.state is State.OFF
    assert machine.arm_braked


def test_the_self_test_of_a_start_reports_low_pressure_and_the_pressed_button():
    machine = Machine.at(State.SLEEP)
    said = act(machine, Action.START_PLATFORM, sight=LOW)
    assert said == "start_platform: the pressure is too low and the panic button is pressed"
    assert machine.state is State.SLEEP


def test_run_before_home_moves_home_first():
    machine = Machine.at(State.IDLE)
    act(machine, Action.RUN)
    assert machine.task is Task.TO_HOME
    machine.watch(1.0, Sight(1e7, 7e6, arrived=True))
    assert machine.state is State.RUN


@pytest.mark.parametrize("state", sorted(ACTIVE))
def test_the_panic_button_freezes_every_state_in_which_the_program_runs(state):
    machine = Machine(state)
    act(machine, Action.PRESS_PANIC)
    assert machine.state is State.FREEZE
    assert not machine.legs_powered


@pytest.mark.parametrize("state", sorted(ACTIVE))
def test_low_pressure_freezes_every_state_in_which_the_program_runs(state):
    machine = Machine(state)
    assert "68 bar" in machine.watch(0.0, Sight(6.8e6, 7e6))[0].message
    assert machine.state is State.FREEZE


def test_low_pressure_is_nothing_to_a_machine_that_sleeps():
    machine = Machine.at(State.SLEEP)
    assert machine.watch(0.0, LOW) == []


@pytest.mark.parametrize(
    ("state", "action", "says"),
    [
        (State.SLEEP, Action.HOME, "does not run (state sleep)"),
        (State.FREEZE, Action.RUN, "does not run (state freeze)"),
        (State.RUN, Action.START_PLATFORM, "runs already"),
        (State.OFF, Action.START_PLATFORM, "no power"),
        (State.START, Action.HOME, "the start is not over"),
        (State.OFF, Action.CRATE_OFF, "no power"),
        (State.RUN, Action.CRATE_ON, "has power"),
        (State.OFF, Action.READ_SENSOR, "does not answer"),
    ],
)
def test_a_transition_that_the_computers_do_not_make_is_refused_in_one_line(state, action, says):
    machine = Machine.at(state) if state is not State.START else Machine(state, until=1.0)
    before = machine.copy()
    notes = machine.act(action, 0.0, GOOD, WATCH)
    assert [note.kind for note in notes] == ["refused"]
    assert says in notes[0].message
    assert machine == before


def test_two_readers_of_the_board_lock_up_both_computers_until_the_crate_is_booted():
    machine = Machine.at(State.RUN)
    act(machine, Action.READ_SENSOR)
    assert not machine.locked  # the flag is set: forces come through shared memory
    act(machine, Action.CLEAR_ACTIVE_FLAG, Action.READ_SENSOR)
    assert machine.locked
    assert machine.legs_powered  # the leg controllers go on with their last lengths
    assert machine.watch(0.0, LOW) == []  # nobody looks at the pressure
    assert "do not answer" in act(machine, Action.IDLE)
    act(machine, Action.PRESS_PANIC, Action.PRESS_ARM_PANIC, Action.CRATE_OFF, Action.CRATE_ON)
    assert not machine.locked
    assert machine.state is State.FREEZE
    assert not machine.flag


def test_the_arm_is_held_by_its_drive_or_its_brake_or_it_falls():
    machine = Machine.at(State.RUN)
    assert (machine.arm_driven, machine.arm_braked) == (True, False)
    act(machine, Action.PRESS_ARM_PANIC)
    assert (machine.arm_driven, machine.arm_braked) == (False, True)
    act(machine, Action.RELEASE_ARM_PANIC)
    assert (machine.arm_driven, machine.arm_braked) == (True, False)
    assert "neither drive nor brake" in act(machine, Action.CRATE_OFF)
    assert (machine.arm_driven, machine.arm_braked) == (False, False)


def test_an_arm_that_is_not_where_it_is_commanded_is_not_taken_over():
    machine = Machine.at(State.RUN)
    act(machine, Action.PRESS_ARM_PANIC)
    away = Sight(1e7, 7e6, arm_in_place=False)
    assert "not where it is commanded" in act(machine, Action.RELEASE_ARM_PANIC, sight=away)
    assert machine.arm_braked


sights = st.builds(
    Sight,
    pressure=st.sampled_from([1e6, 1e7]),
    low_pressure=st.just(7e6),
    arm_in_place=st.booleans(),
    low_platform=st.booleans(),
    arrived=st.booleans(),
)


@given(
    st.sampled_from([s for s in State if s is not State.START]),
    st.lists(st.tuples(st.sampled_from(list(Action)), sights), max_size=40),
)
def test_whatever_operators_do_the_machine_stays_consistent(begin, script):
    machine = Machine.at(begin)
    for k, (action, sight) in enumerate(script):
        notes = machine.act(action, 0.5 * k, sight, WATCH)
        assert notes
        assert all("\n" not in note.message for note in notes)
        machine.watch(0.5 * k, sight)
        assert machine.legs_powered == (machine.state in ACTIVE)
        assert (machine.state is State.OFF) == (not machine.crate)
        assert machine.crate or not machine.locked
        assert (machine.task is Task.NOTHING) == (machine.state not in ACTIVE)
        assert (machine.task is Task.RUN) == (machine.state is State.RUN)
        assert not (machine.arm_driven and machine.arm_braked)
