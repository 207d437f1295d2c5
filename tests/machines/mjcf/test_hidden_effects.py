"""Ripple, Dahl's friction, cross-talk and a payload, hidden in an arm: place, kind and size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from arm import arm, motion

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

LIBRARY = {
    "coulomb_friction": "a b",
    "force_offset": "a b",
    "rotor_inertia": "a b",
    "body_mass": "two",
    "dahl_friction": "a b",
    "ripple": "a.12 a.24 b.24",
    "payload": "two",
}
TALK = '[[effects]]\nkind = "drive_cross_talk"\non = ["*"]\n'
HIDDEN = {
    "ripple@a.24": {"cosine": 0.3, "sine": -0.2},
    "dahl_friction@b": {"level": 0.5, "travel": 0.03},
    "drive_cross_talk@mb from ma": {"share": 0.15},
    "payload@two": {"mass": 0.5, "x": 0.3, "y": -0.1},
}


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return arm(tmp_path_factory.mktemp("arm"), LIBRARY, TALK)


def recorded(machine: Rig, seed: int, values: dict[str, float]) -> Recording:
    time, angles = motion(12.0, seed)
    fed = Excitation("", time, {"qa": angles[:, :1], "qb": angles[:, 1:]})
    rows = MjcfForward.of(machine).simulate(fed, values)
    rows = rows + 0.01 * np.random.default_rng(seed).standard_normal(rows.shape)
    signals = {**fed.drive, "ta": rows[:, :1], "tb": rows[:, 1:]}
    return Recording(time, signals, RecordingInfo("measured", scenario=f"motion {seed}"))


@pytest.mark.parametrize("label", HIDDEN)
def test_what_is_hidden_is_named_with_its_sizes(machine: Rig, label: str, banks: Path) -> None:
    sizes = HIDDEN[label]
    values = {f"{label}:{size}": value for size, value in sizes.items()}
    one, other = (recorded(machine, seed, values) for seed in (1, 2))
    settings = Settings(nulls=20, cache=banks)
    verdict = diagnose([one], machine, held_out=[other], settings=settings).verdict
    assert verdict.verdict is Kind.NAMED
    (cause,) = verdict.causes
    assert f"{cause.effect}@{cause.target}" == label
    assert cause.firm
    for size, value in sizes.items():
        found = cause.shortened.parameters[size]
        # one of nine 90 % intervals would miss; twice as wide it would not (one in a hundred)
        assert abs(found.value - value) < found.high - found.low
    first = next(iter(cause.parameters.values()))
    assert first.low > 0.2 * first.value
