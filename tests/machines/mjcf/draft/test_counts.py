"""Positions in counts of an encoder are asked after, and read once it is known what one is."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import changed

from ves_twin.cli.new_text import new_text
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.new_machine import new_machine

COUNT = 2.0 * np.pi / 20_000


@pytest.fixture
def counts(columns, write):
    """The arm's log with its last joint in counts, by a column's name."""
    told = changed(columns, q3=np.round(columns["q3"] / COUNT))
    del told["dq3"]
    return write({"q3_counts" if name == "q3" else name: rows for name, rows in told.items()})


def test_a_column_in_counts_is_asked_after_before_its_joint_passes_for_locked(arm, counts):
    made = new_machine(arm, [counts], arm.with_name("my.toml"))
    assert made.draft.left["q3_counts"].startswith("position of joint bend in counts")
    assert made.draft.untold == {"q3_counts": "rad per count"}
    told = new_text(made, arm, [counts])
    assert "draft again with what a count is (--scale q3_counts=..., in rad per count)" in told


def test_with_what_a_count_is_a_draft_is_that_of_the_angle(arm, counts, columns, write):
    found = draft(arm, [counts], arm.with_name("a.toml"), scales={"q3_counts": COUNT})
    plain = draft(arm, [write(columns, "plain.csv")], arm.with_name("b.toml"))
    assert 'columns = ["q3_counts"], unit = "rad", scale = 0.000314' in found.text
    assert not found.untold
    for name, share in plain.explained.items():
        assert found.explained[name] == pytest.approx(share, abs=0.02), name


def test_whole_numbers_under_the_name_of_a_slide_are_asked_after_as_well(tmp_path, write):
    path = tmp_path / "cart.xml"
    path.write_text(
        """<mujoco><worldbody><body><joint name="rail" type="slide" axis="1 0 0"/>
        <geom size="0.1" mass="2"/></body></worldbody>
        <actuator><motor name="drive" joint="rail"/></actuator></mujoco>"""
    )
    time = 0.01 * np.arange(800)
    way, pull = 0.2 * np.sin(2.0 * time), -1.6 * np.sin(2.0 * time)
    rows = {"t_s": time, "enc1": np.round(10_000 * way), "force_N": pull}
    found = draft(path, [write(rows)], tmp_path / "cart.toml")
    asked = next(words for words in found.look if "whole numbers alone" in words)
    assert "counts of an encoder, or millimetres?" in asked
    assert found.untold == {"enc1": "m per count"}


def test_an_effort_in_counts_keeps_its_unit_where_a_count_is_known(arm, columns, write):
    """By its unit alone, beside the other two, it is the third motor's."""
    log = {"torque_counts" if n == "tau3" else n: v for n, v in columns.items()}
    log["torque_counts"] = log["torque_counts"] / 1e-3
    scales = {"torque_counts": 1e-3}
    found = draft(arm, [write(log, "u.csv")], arm.with_name("a.toml"), scales=scales)
    assert 'columns = ["torque_counts"], unit = "N*m", scale = 0.001' in found.text
