"""A constant that an owner gives makes a column what it stands for, and all that follows from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drafted import changed

from ves_twin.cli.main import main
from ves_twin.cli.new_text import new_text
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.draft.given_model import GivenModel
from ves_twin.machines.mjcf.draft.judge import Judge
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import matched
from ves_twin.machines.mjcf.draft.spots import spots_of
from ves_twin.machines.new_machine import new_machine


@pytest.fixture
def amperes(columns, write):
    """The arm's log with the third drive in amperes of 0.05 N m."""
    log = changed(columns, tau3=columns["tau3"] / 0.05)
    return write({"i3_A" if name == "tau3" else name: rows for name, rows in log.items()})


def test_a_draft_with_the_constant_is_that_of_the_torque(arm, amperes, columns, write):
    """Written into the file afterwards it left a low-pass of 52 Hz where 14 is right."""
    told = draft(arm, [amperes], arm.with_name("a.toml"), scales={"i3_A": 0.05})
    plain = draft(arm, [write(columns, "plain.csv")], arm.with_name("b.toml"))
    assert told.explained["i3_A"] == pytest.approx(plain.explained["tau3"])
    assert told.mode == plain.mode
    for line in ("drive =", "tolerances =", "lift = {", "bend = {"):
        one, other = (next(t for t in d.text.splitlines() if line in t) for d in (told, plain))
        assert one.split("#")[0] == other.split("#")[0]
    assert "scale = 0.05" in told.text
    assert not told.untold
    assert not any("i3_A is electrical" in words for words in told.look)


def test_a_constant_that_nothing_tells_is_asked_for_first(arm, columns, write):
    noise = np.random.default_rng(5).standard_normal(len(columns["t"]))
    told = changed(columns, tau3=noise)
    log = write({"i3_A" if name == "tau3" else name: rows for name, rows in told.items()})
    made = new_machine(arm, [log], arm.with_name("my.toml"))
    text = new_text(made, arm, [log])
    assert made.draft.untold == {"i3_A": "N*m per A"}
    assert (
        "next      draft again with what the motors give (--scale i3_A=..., in N*m per A)" in text
    )


def test_a_constant_that_is_given_is_never_turned(arm, amperes):
    """A flexible arm's voltage, 25 ms late in its loop, takes energy by its work: it was right."""
    told = draft(arm, [amperes], arm.with_name("a.toml"), scales={"i3_A": -0.05})
    assert "scale = -0.05" in told.text
    words = "i3_A acts against this model (slope -"
    assert any(one.startswith(words) and "stays as it is given" in one for one in told.look)


def test_a_position_whose_constant_is_given_is_never_turned_either(arm, columns, write):
    log = write(changed(columns, q2=-columns["q2"]))
    told = draft(arm, [log], arm.with_name("a.toml"), scales={"q2": 1.0})
    plain = draft(arm, [log], arm.with_name("b.toml"))
    line = next(text for text in told.text.splitlines() if 'columns = ["q2"]' in text)
    assert "scale" not in line.split("#")[0]
    assert any(words.startswith("q2 counts against") for words in plain.look)
    assert not any(words.startswith("q2 counts against") for words in told.look)


@pytest.mark.parametrize(("name", "sound"), [("q3_rad", False), ("q3", True)])
def test_amperes_tell_no_other_unit_than_a_name_does(arm, columns, write, name, sound):
    """In degrees a joint takes 57 times the torque an ampere, and any constant may stand there."""
    names = {"q3": name, "tau3": "i3_A"}
    log = write({names.get(one, one): rows for one, rows in columns.items()})
    read, model = LogColumns.read(log, None), GivenModel.read(arm).model
    found = list(matched(read, spots_of(model)).found)
    other = [replace(m, unit="deg") if m.column == name else m for m in found]
    assert Judge(read, model, 20.0).sound(other, found) is sound


def test_the_back_emf_of_a_motor_takes_no_typical_effort_away(swing, write):
    path, columns = swing
    plain = draft(path, [write(columns)], path.with_name("a.toml")).text
    motor = path.read_text()
    braked = '<general name="drive" joint="joint" biastype="affine" biasprm="0 0 -0.05"/>'
    other = motor.replace('<motor name="drive" joint="joint"/>', braked)
    assert other != motor
    path.write_text(other)
    told = draft(path, [write(columns)], path.with_name("b.toml")).text
    typical = "joint = { effort = "
    one, two = (float(text.split(typical)[1].split(",")[0]) for text in (plain, told))
    assert two == pytest.approx(one, rel=1e-6)


def test_a_constant_of_no_column_or_no_number_is_one_line(arm, amperes, capsys):
    with pytest.raises(UnknownNameError, match="did you mean 'i3_A'"):
        draft(arm, [amperes], arm.with_name("a.toml"), scales={"i3": 0.05})
    with pytest.raises(InvalidInputError, match="constant of i3_A"):
        draft(arm, [amperes], arm.with_name("a.toml"), scales={"i3_A": 0.0})
    asked = ["new", str(arm), str(amperes), "--out", str(arm.with_name("c.toml")), "--scale"]
    for text in ("i3_A", "=2", "i3_A=much", "i3_A=nan"):
        assert main([*asked, text]) == 2
        assert "expected COLUMN=NUMBER" in capsys.readouterr().err
    assert main([*asked, "i3_A=0.05", "--scale", "i3_A=0.06"]) == 2
    assert "expected one constant of a column" in capsys.readouterr().err
    assert main([*asked, "i3_A=0.05"]) == 0
    assert "N*m per A is given" in capsys.readouterr().out


def test_a_second_log_that_is_too_short_is_told(swing, write):
    path, columns = swing
    short = write({name: rows[:90] for name, rows in columns.items()}, "check.csv")
    found = draft(path, [write(columns), short], path.with_name("my.toml"))
    assert found.short
    assert any("rows of check" in words for words in found.look)
