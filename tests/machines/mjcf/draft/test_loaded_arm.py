"""The last body of an arm, as `new` drafts it, has a tool on it: its mass is named, and right."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from three_joints import ARM, moved

from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.load import open_machine
from ves_twin.machines.new_machine import new_machine

QUICK = Settings(nulls=4)
"""Thresholds matter little where causes stand out by thousands of chi^2."""

LOADED = 3.0
"""Mass of the last body [kg]; the model has 1 kg."""

FRICTION = np.array([1.5, 3.0, 0.8])[:, None]
"""Dry friction of each joint [N m]."""


def logged(folder, seed):
    """A log of an arm with a heavy end, dry friction, and 1 % of slow error.

    The load lies along the body: of one that moves its centre a rigid arm tells the first moment
    alone, which a centre of the body before it may have as well.
    """
    spec = mujoco.MjSpec.from_string(ARM)
    spec.body("lower").geoms[0].mass = LOADED
    time, q, v, torque = moved(spec.compile(), seed)
    rng = np.random.default_rng(seed + 100)
    slow = np.cumsum(rng.standard_normal(torque.shape), axis=1)
    slow -= np.linspace(slow[:, 0], slow[:, -1], slow.shape[1], axis=1)
    slow *= 0.01 * np.std(torque, axis=1, keepdims=True) / np.std(slow, axis=1, keepdims=True)
    torque = torque + FRICTION * np.sign(v) + slow + 0.01 * rng.standard_normal(torque.shape)
    rows = np.vstack([time, q + 1e-6 * rng.standard_normal(q.shape), torque]).T
    path = folder / f"log{seed}.csv"
    np.savetxt(path, rows, "%.9g", ",", header="t,q1,q2,q3,tau1,tau2,tau3", comments="")
    return path


@pytest.mark.nightly
def test_an_end_of_three_times_its_mass_is_named_by_its_mass(arm, tmp_path):
    fit, held = (logged(tmp_path, seed) for seed in (11, 12))
    path = new_machine(arm, [fit, held], tmp_path / "my.toml").path
    machine = open_machine(str(path))
    recordings = [machine.read(str(log)) for log in (fit, held)]
    told = diagnose(recordings[:1], machine, held_out=recordings[1:], settings=QUICK).verdict
    found = {f"{c.effect}@{c.target}": c for c in told.causes}
    assert {f"coulomb_friction@{joint}" for joint in ("turn", "lift", "bend")} <= found.keys()
    (mass,) = found["body_mass@lower"].parameters.values()
    assert mass.low <= LOADED <= mass.high
    assert mass.value == pytest.approx(LOADED, rel=0.05)
    for error in told.residuals.values():
        assert error.after_si < 0.1 * error.before_si
