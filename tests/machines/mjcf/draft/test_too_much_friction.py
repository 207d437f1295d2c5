"""A model whose friction is a placeholder is told, and all of it may be missing."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted
from three_joints import ARM

from ves_twin.machines.mjcf.draft.too_much_friction import too_much_friction


def rough(text, joint, dry):
    return text.replace(f'name="{joint}"', f'name="{joint}" frictionloss="{dry}"')


@pytest.mark.parametrize(("dry", "told"), [(0.5, False), (50.0, True)])
def test_friction_beyond_all_that_was_measured_is_asked_after(arm, columns, write, dry, told):
    arm.write_text(rough(arm.read_text(), "bend", dry))
    found, _ = drafted(arm, write(columns))
    look = [words for words in found.look if "placeholders" in words]
    assert len(look) == told
    assert all("bend (50 for" in words and "turn (" not in words for words in look)


def test_what_stands_still_and_a_motor_s_own_damping_count_as_they_are():
    model = mujoco.MjModel.from_xml_string(rough(ARM, "turn", 2.0))
    speed = np.concatenate([np.zeros(50), np.sin(np.linspace(0.0, 6.0, 50))])
    quiet = {"turn": (0.1 * speed, speed), "lift": (5.0 * speed, speed)}
    (words,) = too_much_friction(model, quiet)
    assert "turn (1.5 for" in words
    assert "lift" not in words
    assert too_much_friction(model, {"turn": (3.0 * np.ones(100), speed)}) == []


def test_all_of_a_friction_that_the_model_has_may_be_missing(arm, columns, write):
    arm.write_text(rough(arm.read_text(), "bend", 50.0))
    _, rig = drafted(arm, write(columns))
    found = {p.name: p for p in rig.parameters}["coulomb_friction@bend:level"]
    assert (found.nominal, found.low) == (50.0, 0.0)
    (cause,) = [h for h in rig.hypotheses if h.label == "coulomb_friction@bend"]
    assert cause.largest[0] == 50.0
    assert cause.departures().min() <= -40.0
