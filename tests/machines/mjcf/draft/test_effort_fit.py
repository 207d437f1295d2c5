"""An effort on what the model needs: friction beside it brakes, and does not drive."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.machines.mjcf.draft.effort_fit import EffortFit

TIME = np.linspace(0.0, 6.0, 600)


@pytest.mark.parametrize("turned", [1.0, -1.0], ids=["right", "turned"])
@pytest.mark.parametrize(("friction", "pushes"), [(0.8, False), (-0.8, True)])
@pytest.mark.parametrize("speed", [np.sin(2.0 * TIME), 1.2 + np.sin(2.0 * TIME)], ids=["to", "on"])
def test_a_friction_that_would_drive_its_joint_is_told_whatever_the_sign(
    speed, friction, pushes, turned
):
    """`on`: a joint that never reverses, where dry friction and a constant are one."""
    need = np.cos(2.0 * TIME) + 0.3 * np.sin(3.7 * TIME)
    effort = turned * (need + friction * speed)
    fit = EffortFit.of(effort, need, speed, False, 0.0)
    assert fit.pushes is pushes
    assert fit.slope == pytest.approx(turned, rel=1e-6)


def test_a_model_that_brakes_too_much_is_no_friction_that_drives():
    speed, need = np.sin(2.0 * TIME), np.cos(2.0 * TIME) + 0.3 * np.sin(3.7 * TIME)
    brakes = 1.0 * speed
    assert not EffortFit.of(need + 0.5 * speed, need + brakes, speed, False, brakes).pushes
    assert EffortFit.of(need - 0.5 * speed, need + brakes, speed, False, brakes).pushes
