"""Appendix E: each rule is seen to be broken when the machine or the laboratory breaks it."""

from dataclasses import replace

import pytest

from ves_twin.control.operation import machine
from ves_twin.control.operation.machine import Machine
from ves_twin.control.operation.state import Action, State
from ves_twin.plant.laboratory import Laboratory
from ves_twin.plant.plant import Plant
from ves_twin.simulator.switches import Switches
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluators.registry import ANSWERS
from ves_twin.thesis.verdict import Verdict


@pytest.fixture(scope="module")
def nominal():
    return Plant.load("ves2")


@pytest.fixture(scope="module")
def fast():
    return Plant.load("ves2_fast")


@pytest.mark.slow
def test_a_button_that_leaves_the_legs_powered_fails_the_first_rule(verdict_on, fast, monkeypatch):
    assert verdict_on("C116", fast) == Verdict.REPRODUCED
    monkeypatch.setattr(Machine, "legs_powered", property(lambda machine: True))
    assert verdict_on("C116", fast) == Verdict.DIFFERS


def test_brakes_that_come_on_without_power_fail_the_rule_of_the_crate(
    verdict_on, fast, monkeypatch
):
    assert verdict_on("C117", fast) == Verdict.REPRODUCED
    braked = property(lambda machine: machine.arm_panic or not machine.crate)
    monkeypatch.setattr(Machine, "arm_braked", braked)
    assert verdict_on("C117", fast) == Verdict.DIFFERS


@pytest.mark.slow
def test_a_higher_ceiling_fails_the_rule_of_the_upright_arm(verdict_on, fast, monkeypatch):
    assert verdict_on("C118", fast) == Verdict.REPRODUCED
    high = replace(Laboratory.load(), ceiling=2.5)
    monkeypatch.setattr(Laboratory, "load", staticmethod(lambda: high))
    assert verdict_on("C118", fast) == Verdict.DIFFERS


def test_a_start_that_looks_only_at_the_button_fails_the_self_test(verdict_on, fast, monkeypatch):
    assert verdict_on("C119", fast) == Verdict.REPRODUCED
    monkeypatch.setattr(Machine, "_why_not", lambda machine, action, sight: "the button")
    assert verdict_on("C119", fast) == Verdict.DIFFERS


def test_loops_that_close_beside_the_legs_lengths_move_the_platform(verdict_on, fast, monkeypatch):
    close = Switches.close_loops
    assert verdict_on("C120", fast) == Verdict.REPRODUCED
    monkeypatch.setattr(Switches, "close_loops", lambda switches: close(switches) + 0.005)
    assert verdict_on("C120", fast) == Verdict.DIFFERS


def test_readers_that_share_the_board_fail_the_rule_of_the_flag(verdict_on, fast, monkeypatch):
    assert verdict_on("C121", fast) == Verdict.REPRODUCED
    monkeypatch.setitem(machine._BUTTONS, Action.READ_SENSOR, lambda machine: [])
    assert verdict_on("C121", fast) == Verdict.DIFFERS


def test_gravity_mode_waits_for_its_signal_and_one_that_does_not_is_seen(
    claims, nominal, monkeypatch
):
    claim = claims["C124"]
    assert ANSWERS["C124"](Context(nominal, True), claim).holds
    monkeypatch.setattr(
        Machine, "at", staticmethod(lambda state: Machine(State.RUN))
    )  # runs from the beginning
    assert not ANSWERS["C124"](Context(nominal, True), claim).holds


def test_a_machine_that_goes_to_sleep_from_anywhere_fails_the_order(verdict_on, fast, monkeypatch):
    assert verdict_on("C126", fast) == Verdict.REPRODUCED
    slept = Machine._move

    def at_once(machine, action):
        notes = slept(machine, action)
        return machine._at_home() if action == "sleep" else notes

    monkeypatch.setattr(Machine, "_move", at_once)
    assert verdict_on("C126", fast) == Verdict.DIFFERS


def test_the_recovery_is_in_the_order_of_the_handbook(verdict_on, fast, monkeypatch):
    assert verdict_on("C128", fast) == Verdict.REPRODUCED
    stuck = {Action.RELEASE_PANIC: lambda machine: []}
    monkeypatch.setattr(machine, "_BUTTONS", {**machine._BUTTONS, **stuck})
    assert verdict_on("C128", fast) == Verdict.DIFFERS
