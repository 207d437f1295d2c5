"""Where no joint turns round, dry friction and a constant force are one, whichever is offered."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arm import arm
from numpy.typing import NDArray

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.widened import Widened
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.report.diagnosis.answer import confidence_sentence, next_step

TIME = 0.02 * np.arange(600)
HIDDEN = {
    "coulomb_friction@a:level": 0.5,
    "coulomb_friction@b:level": 0.4,
    "ripple@a.12:cosine": 0.1,
    "ripple@b.24:sine": 0.1,
}
OFFERED = {
    "coulomb_friction": "a b",
    "coulomb_asymmetry": "a",
    "force_offset": "a b",
    "regularized_friction": "a",
    "ripple": "a.12 b.24",
    "stribeck_friction": "a",
    "viscous_asymmetry": "a",
}
SIZES = {
    "coulomb_friction@a": {"level": 0.5},
    "coulomb_asymmetry@a": {"level": 0.5},
    "force_offset@a": {"offset": 0.5},
    "regularized_friction@a": {"level": 0.5, "transition": 0.05},
    "stribeck_friction@a": {"level": 0.5, "fall": 4.0},
    "viscous_asymmetry@a": {"slope": 0.5},
}


def turned(seed: int, back: float) -> NDArray[np.float64]:
    """Angles (n, 2) that go on, with swings; times `back` of its mean speed, also the other way."""
    rng = np.random.default_rng(seed)
    omega, phase = rng.uniform(1.0, 4.0, (2, 3)), rng.uniform(0.0, 6.3, (2, 3))
    swings = np.sum(np.sin(omega[..., None] * TIME + phase[..., None]) / omega[..., None], axis=1)
    return np.asarray((0.4 * TIME + 0.4 * back / 3.0 * swings).T)


def fed(seed: int, back: float) -> Excitation:
    angles = turned(seed, back)
    return Excitation("", TIME, {"qa": angles[:, :1], "qb": angles[:, 1:]})


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return arm(tmp_path_factory.mktemp("whole"), OFFERED)


def recorded(rig: Rig, seed: int, back: float, hidden: Mapping[str, float] = HIDDEN) -> Recording:
    programme = fed(seed, back)
    rows = MjcfForward.of(rig).simulate(programme, hidden)
    rows = rows + 0.01 * np.random.default_rng(seed).standard_normal(rows.shape)
    signals = {**programme.drive, "ta": rows[:, :1], "tb": rows[:, 1:]}
    return Recording(TIME, signals, RecordingInfo("measured", scenario=f"motion {seed}"))


@pytest.mark.parametrize("back", [0.8, 4.0])
def test_a_friction_is_proved_and_firm_only_where_its_joint_turns_round(
    rig: Rig, back: float, tmp_path: Path, banks: Path
) -> None:
    """Of a youBot it was firm where friction alone was offered, and so was the offset alone."""
    offered = arm(tmp_path, {"coulomb_friction": "a b"})
    one, other = (recorded(rig, seed, back) for seed in (1, 2))
    settings = Settings(nulls=20, cache=banks, laws=False)
    verdict = diagnose([one], offered, held_out=[other], settings=settings).verdict
    found = {proved.label: proved for proved in verdict.proved}
    assert found.keys() == {"coulomb_friction@a", "coulomb_friction@b"}
    for label, proved in found.items():
        twin = label.replace("coulomb_friction", "force_offset")
        assert proved.firm is (back > 1.0)
        assert proved.acts_like == (() if back > 1.0 else (twin,))
        assert proved.one_way is (back < 1.0)
    assert ("A motion in which a and b reverse" in next_step(verdict)) is (back < 1.0)


@pytest.mark.parametrize("back", [0.8, 4.0])
def test_a_friction_that_is_named_alone_is_provisional_where_its_joint_goes_one_way(
    rig: Rig, back: float, tmp_path: Path, banks: Path
) -> None:
    offered = arm(tmp_path, {"coulomb_friction": "a b"})
    hidden = {"coulomb_friction@a:level": 0.5}
    one, other = (recorded(rig, seed, back, hidden) for seed in (1, 2))
    settings = Settings(nulls=20, cache=banks, laws=False)
    verdict = diagnose([one], offered, held_out=[other], settings=settings).verdict
    assert verdict.verdict is Kind.NAMED
    (cause,) = verdict.causes
    assert cause.firm is (back > 1.0)
    assert ("force offset at a reads the same" in confidence_sentence(verdict)) is not cause.firm
    assert ("force_offset@a" in verdict.words) is not cause.firm


ONE_WAY = {
    "coulomb_friction@a": "force_offset@a",
    "coulomb_asymmetry@a": "force_offset@a",
    "force_offset@a": "coulomb_friction@a",
    "regularized_friction@a": "force_offset@a",
    "stribeck_friction@a": "force_offset@a",
    "viscous_asymmetry@a": "viscous_friction@a",
}


def twin_of(rig: Rig, label: str, sizes: dict[str, float], *backs: float) -> tuple[str, ...]:
    values = {f"{label}:{size}": value for size, value in sizes.items()}
    moments = [(fed(seed, back), values) for seed, back in enumerate(backs)]
    wrapped = Widened(MjcfForward.of(rig), 2.0)
    return wrapped.one_way_twins([label], moments).get(label, ())


@pytest.mark.parametrize("label", ONE_WAY)
def test_a_cause_of_a_joint_that_goes_one_way_has_a_twin_that_nothing_offers(
    rig: Rig, label: str
) -> None:
    """One recording that turns round, of two, is enough to tell them apart."""
    assert twin_of(rig, label, SIZES[label], 0.8, 0.5) == (ONE_WAY[label],)
    assert twin_of(rig, label, SIZES[label], 0.8, 4.0) == ()


def test_a_force_that_pushes_a_joint_on_is_like_no_friction(rig: Rig) -> None:
    assert twin_of(rig, "force_offset@a", {"offset": -0.5}, 0.8) == ()


def test_a_friction_that_falls_within_the_speeds_of_a_record_is_no_constant(rig: Rig) -> None:
    assert twin_of(rig, "stribeck_friction@a", {"level": 0.5, "fall": 0.3}, 0.8) == ()


def test_a_slow_recording_that_turns_round_tells_what_a_fast_one_does_not(rig: Rig) -> None:
    twins = MjcfForward.of(rig).one_way_twins
    slow = fed(1, 4.0)
    drive = {name: 0.02 * rows for name, rows in slow.drive.items()}
    moments = [(fed(0, 0.8), {"coulomb_friction@a:level": 0.5})]
    assert twins(["coulomb_friction@a"], moments)
    moments += [(replace(slow, drive=drive), {"coulomb_friction@a:level": 0.5})]
    assert not twins(["coulomb_friction@a"], moments)
