"""Columns called posa1 and posd1, of what was measured and what was asked for."""

from __future__ import annotations

import pytest
from drafted import drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.said import said


def renamed(columns, names, **beside):
    """The arm's log with positions and torques under other names, without its speeds."""
    found = {"t": columns["t"]}
    for n in (1, 2, 3):
        found |= {names[0].format(n): columns[f"q{n}"], names[1].format(n): columns[f"tau{n}"]}
        found |= {name.format(n): 1.01 * columns[f"q{n}"] for name in beside.values()}
    return found


@pytest.mark.parametrize(
    ("actual", "effort", "asked"),
    [
        ("posa{}", "trq{}", "posd{}"),
        ("posact{}", "trqact{}", "posref{}"),
        ("qa{}", "trq{}", "qd{}"),
        ("pos_a_{}", "trq{}", "pos_d_{}"),
    ],
)
def test_the_actual_position_is_matched_and_the_desired_one_is_a_set_point(
    arm, write, columns, actual, effort, asked
):
    found, _ = drafted(arm, write(renamed(columns, (actual, effort), asked=asked)))
    taken = {guess.column: guess.taken_for for guess in found.guesses}
    for n, joint in enumerate(("turn", "lift", "bend"), 1):
        assert taken[actual.format(n)].startswith(f"position of joint {joint}")
        assert taken[effort.format(n)].startswith(f"actuator m{n}")
        assert found.left[asked.format(n)] == "says what was asked for"


def test_numbers_tell_the_actual_position_where_no_desired_one_was_recorded(arm, write, columns):
    found, _ = drafted(arm, write(renamed(columns, ("posa{}", "trq{}"))))
    assert {"posa1", "posa2", "posa3"} <= {guess.column for guess in found.guesses}


@pytest.mark.parametrize(
    "names",
    [
        ("q1", "qd1", "qdd1"),
        ("q1", "qd1", "qa1"),
        ("theta", "thetad"),
        ("posa", "posb", "posc"),
        ("ia", "ib", "ic", "id"),
        ("xa", "xd"),
        ("position", "goal_position", "command1"),
    ],
)
def test_a_rate_an_axis_or_a_phase_is_neither_actual_nor_desired(names):
    assert said(names) == {name: name for name in names}


def test_a_refusal_says_by_which_names_a_position_is_read(arm, write, columns):
    log = write(renamed(columns, ("stand{}", "trq{}")))
    with pytest.raises(
        InvalidInputError, match=r"name like pos_turn or q1 .* rename it"
    ) as refusal:
        drafted(arm, log)
    assert "\n" not in str(refusal.value)
    named = {"q1": "pos_turn", "q2": "pos_lift"}
    kept = {named.get(name, name): rows for name, rows in columns.items() if name[0] != "d"}
    found, _ = drafted(arm, write(kept))
    assert {"pos_turn", "pos_lift", "q3"} <= {guess.column for guess in found.guesses}


@pytest.mark.parametrize("names", [("q_meas_1", "qd_1"), ("q_act1", "qd1", "qdd1")])
def test_a_rate_beside_a_measured_position_is_no_set_point(names):
    told = said(names)
    assert [told[name] for name in names[1:]] == [*names[1:]]
    assert told[names[0]] == "q_actual_1"
