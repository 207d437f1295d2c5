"""An arm on a wall: its model's gravity is asked after, and no column is turned for it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from drafted import drafted, scales
from three_joints import ARM, moved

from ves_twin.cli.new_text import new_text
from ves_twin.machines.mjcf.draft.mounted import mounted
from ves_twin.machines.new_machine import NewMachine

ON = {"wall": "0 9.81 0", "floor": "0 0 -9.81"}


def torques(place: str) -> dict[str, np.ndarray]:
    """A log of the arm where it is mounted."""
    model = mujoco.MjModel.from_xml_string(
        ARM.replace('timestep="0.001"', f'timestep="0.001" gravity="{ON[place]}"')
    )
    time, q, _, torque = moved(model, 2)
    columns = {"t": time} | {f"q{i + 1}": q[i] for i in range(3)}
    return columns | {f"tau{i + 1}": torque[i] for i in range(3)}


def test_gravity_of_an_arm_on_a_wall_is_asked_after_and_nothing_is_turned(arm, write):
    found, rig = drafted(arm, write(torques("wall")))
    assert any("gravity along +y, not along -z" in words for words in found.look)
    assert not any("turned" in words or "swapped" in words for words in found.look)
    assert set(scales(rig).values()) == {1.0}
    said = new_text(NewMachine(Path("my.toml"), None, found), arm, [Path("log.csv")])
    assert "see to the gravity in arm.xml" in said.splitlines()[-1]


def test_of_an_arm_on_a_floor_nothing_is_said(arm, write):
    found, _ = drafted(arm, write(torques("floor")))
    assert found.gravity == ""
    assert not any("gravity" in words for words in found.look)


@pytest.mark.parametrize("along", ["1 0 0", "0 0 0", "0 0 3"])
def test_the_gravity_that_scores_best_is_told(along):
    model = mujoco.MjModel.from_xml_string(ARM)
    model.opt.gravity[:] = [0.0, 0.0, -3.0]
    truth = np.array([float(n) for n in along.split()])
    truth = 3.0 * truth / max(float(np.linalg.norm(truth)), 1.0)
    found = mounted(model, lambda other: -float(np.linalg.norm(other.opt.gravity - truth)))
    assert found is not None
    np.testing.assert_array_equal(found.model.opt.gravity, truth)
    assert np.array_equal([float(n) for n in found.numbers.split()], truth)
    np.testing.assert_array_equal(model.opt.gravity, [0.0, 0.0, -3.0])


def test_no_other_gravity_is_told_where_the_model_has_the_best():
    model = mujoco.MjModel.from_xml_string(ARM)
    assert mounted(model, lambda other: -float(other.opt.gravity[2])) is None


def test_positions_that_all_count_the_other_way_are_no_ceiling(arm, write):
    columns = torques("floor")
    turned = {name: -values if name.startswith("q") else values for name, values in columns.items()}
    found, _ = drafted(arm, write(turned))
    assert found.gravity == ""
    assert not any("gravity" in words for words in found.look)
    assert min(found.explained.values()) > 0.95


def test_a_spring_that_a_level_machine_has_and_its_model_lacks_is_no_gravity(arm, write):
    level = ARM.replace('axis="0 1 0"', 'axis="0 0 1"')
    arm.write_text(level)
    sprung = mujoco.MjModel.from_xml_string(level)
    sprung.jnt_stiffness[:] = [3.0, 2.0, 1.0]
    time, q, _, torque = moved(sprung, 2)
    columns = {"t": time} | {f"q{i + 1}": q[i] for i in range(3)}
    found, _ = drafted(arm, write(columns | {f"tau{i + 1}": torque[i] for i in range(3)}))
    assert found.gravity == ""
    assert not any("gravity" in words for words in found.look)
