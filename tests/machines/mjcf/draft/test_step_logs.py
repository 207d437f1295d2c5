"""Logs of step tests: a command that never changes, readings that rows repeat, a clock of rows."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.machine import Rig


@pytest.fixture
def step(swing) -> tuple[Path, dict[str, np.ndarray]]:
    """The pendulum under 0.3 N m from its first row on: t, tau, q."""
    model = mujoco.MjModel.from_xml_path(str(swing[0]))
    data, q = mujoco.MjData(model), np.zeros(800)
    data.ctrl[0] = 0.3
    for k in range(len(q)):
        q[k] = data.qpos[0]
        for _ in range(5):
            mujoco.mj_step(model, data)
    q += 0.001 * np.random.default_rng(3).standard_normal(800)
    return swing[0], {"t": 0.01 * np.arange(800), "tau": np.full(800, 0.3), "q": q}


@pytest.mark.parametrize("name", ["tau", "U_V"])
def test_a_step_test_is_drafted_with_the_command_that_never_changes(step, write, name):
    """It was refused: *expected an effort of motor*, beside the column that told it."""
    path, columns = step
    log = write({name if key == "tau" else key: rows for key, rows in columns.items()})
    found, rig = drafted(path, log)
    assert rig.description.signals["drive.effort"].columns == (name,)
    assert rig.description.signals["drive.effort"].scale == 1.0  # nothing tells another sign
    assert found.explained["joint.position"] > 0.99
    assert name not in found.left


def test_a_column_that_never_changes_is_none_where_another_effort_does(step, write):
    path, columns = step
    moving = 0.3 + 0.01 * np.sin(columns["t"])
    found, rig = drafted(path, write({**columns, "tau": moving, "i_A": np.full(800, 2.0)}))
    assert rig.description.signals["drive.effort"].columns == ("tau",)
    assert found.left["i_A"] == "never changes"
    with pytest.raises(InvalidInputError, match="an effort of drive"):
        drafted(path, write(changed(columns, tau=np.zeros(800))))


def test_readings_that_rows_repeat_are_taken_straight_between(swing, write):
    """Held for 5 rows of 10 ms they are 20 ms late, and 44 of a pendubot's 55 mrad were that."""
    path, columns = swing
    held = columns["q"][5 * (np.arange(1500) // 5)]
    log = write(changed({k: columns[k] for k in ("t", "tau", "q")}, q=held))
    found, rig = drafted(path, log)
    assert rig.description.signals["joint.position"].repeats == 5
    assert any("up to 5 rows until the next one comes, 20 Hz" in words for words in found.look)
    read = read_rig_recording(log, rig)["joint.position"][:, 0]
    off = [np.std(one - columns["q"]) for one in (read, held)]
    assert off[0] < 0.25 * off[1]
    assert rig.description.signals["joint.position"].noise == pytest.approx(0.003, rel=0.7)


@pytest.mark.parametrize("damping", [0.05, 0.5])
def test_a_step_in_volts_of_a_model_that_is_wrong_is_drafted_open_loop(step, write, damping):
    """Motion was given, its band followed from an effort of no size, and that was a traceback."""
    path, columns = step
    path.write_text(path.read_text().replace('damping="0.05"', f'damping="{damping}"'))
    rows = {
        ("U_V" if k == "tau" else k): v * (40.0 if k == "tau" else 1.0) for k, v in columns.items()
    }
    found, rig = drafted(path, write(rows))
    assert rig.description.drive.mode.value == "control"
    assert found.mode.startswith("control: U_V never changes")


@pytest.mark.parametrize("name", ["supply_V", "battery_voltage", "current_limit_A"])
def test_what_is_set_once_is_no_command(step, write, name):
    path, columns = step
    rows = {(name if key == "tau" else key): values for key, values in columns.items()}
    with pytest.raises(InvalidInputError, match="an effort of drive"):
        drafted(path, write(rows))


def test_an_angle_that_wraps_is_unwound_before_its_readings_are_joined(swing, write):
    """A line through each wrap hid it, and a wheel was 408 rad off."""
    path, columns = swing
    turns = 0.1 * np.arange(1500) + 0.3 * np.sin(0.05 * np.arange(1500))
    held = turns[5 * (np.arange(1500) // 5)]
    rows = {"t": columns["t"], "tau": columns["tau"], "q": (held + np.pi) % (2.0 * np.pi) - np.pi}
    log = write(rows)
    path.with_name("my.toml").write_text(drafted(path, write(columns, "plain.csv"))[0].text)
    text = (
        path.with_name("my.toml")
        .read_text()
        .replace('columns = ["q"]', 'repeats = 5, columns = ["q"]')
    )
    path.with_name("own.toml").write_text(re.sub(r'(?m)^"joint.speed".*$', "", text))
    read = read_rig_recording(log, Rig.load(str(path.with_name("own.toml"))))
    off = (read["joint.position"][:, 0] - turns)[:-5]  # no reading ends the last ones
    assert np.max(np.abs(off - np.median(off))) < 0.1
    poses = (
        path.with_name("own.toml").read_text().replace('column = "t"', 'column = "t", poses = true')
    )
    path.with_name("poses.toml").write_text(poses)
    with pytest.raises(InvalidInputError, match="repeats"):
        Rig.load(str(path.with_name("poses.toml")))


def test_efforts_that_are_measured_are_joined_as_positions_are(arm, columns, write):
    """Held beside positions that are not they lagged, and two clocks were suspected."""
    at = 5 * (np.arange(1600) // 5)
    held = {k: v[at] if k != "t" else v for k, v in columns.items() if not k.startswith("dq")}
    found, rig = drafted(arm, write(held))
    assert not any("lag" in words for words in found.look)
    assert rig.description.signals["m2.effort"].repeats == 5


def test_the_only_column_of_a_position_left_is_that_of_the_only_joint_left(arm, columns, write):
    """`rw angle` of a reaction wheel, its unit in no header, had been left out."""
    named = {"turn angle": "q1", "lift angle": "q2", "third angle": "q3"}
    log = {"t": columns["t"], **{name: columns[q] for name, q in named.items()}}
    log |= {name: rows for name, rows in columns.items() if name.startswith("tau")}
    found, rig = drafted(arm, write(log))
    assert rig.description.signals["bend.position"].columns == ("third angle",)
    assert any("the only one left" in guess.why for guess in found.guesses)
    two = {"other angle" if name == "lift angle" else name: rows for name, rows in log.items()}
    rig = drafted(arm, write(two))[1]
    assert not {"lift.position", "bend.position"} & set(rig.description.signals)


def test_of_a_clock_that_may_count_rows_the_draft_says_how_to_tell(swing, write):
    path, columns = swing
    rows = {**columns, "t": np.arange(1500.0)}
    words = " ".join(drafted(path, write(rows))[0].look)
    assert "if it counts rows, --rate says how many a second" in words
    found, rig = drafted(path, write(rows), 100.0)
    assert rig.description.clock.rate == 100.0
    assert found.explained["joint.position"] > 0.9
