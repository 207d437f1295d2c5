"""Logs of step tests: a command that never changes, readings that rows repeat, a clock of rows."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording


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
