"""Causes that the measured motion itself asks for, where simulations are far from it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from arm import arm, motion
from lively_arm import lively, measured

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up.inverse_start import inverse_start
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.machines.mjcf.motion.forward import MjcfForward

HIDDEN = {
    "coulomb_friction@a:level": 0.12,
    "viscous_friction@a:damping": 0.02,
    "rotor_inertia@a:inertia": 0.006,
    "body_mass@two:mass": 0.07,
    "actuator_gain@motor:gain": -0.12,
}
"""Departures: half a second on, a simulation without them is out of step."""


@pytest.fixture(scope="module")
def forward(tmp_path_factory: pytest.TempPathFactory) -> MjcfForward:
    return MjcfForward.of(lively(tmp_path_factory.mktemp("lively")))


@pytest.fixture(scope="module")
def seen(forward: MjcfForward) -> Dataset:
    nominal = {p.name: p.nominal for p in forward.parameters}
    values = {name: nominal[name] + size for name, size in HIDDEN.items()}
    return preprocess(forward, [measured(forward.rig, values, 6.0, 1)])


def desk(forward: MjcfForward) -> SimpleNamespace:
    screen = SimpleNamespace(bank=SimpleNamespace(hypotheses=forward.hypotheses))
    return SimpleNamespace(first=SimpleNamespace(screen=screen), progress=silent)


def fitted(seen: Dataset, shift: np.ndarray) -> Fit:
    """Commissioning errors alone, from departures."""
    evidence = Evidence(seen.runs, seen.measured, whitening_declared(seen.runs))
    return refine(evidence, (), shift, linearise(seen.runs, shift), 2)


def left(seen: Dataset, point: np.ndarray) -> np.ndarray:
    return np.sqrt(np.mean(np.square(seen.measured - seen.runs.one(point)), axis=0))


def test_a_simulation_from_there_is_nearer_than_any_within_the_tolerances(forward, seen):
    known = fitted(seen, seen.runs.origin)
    start = inverse_start(desk(forward), seen, known)
    assert start is not None
    labels = {trial.cause.label for trial in start.present}
    assert "coulomb_friction@a" in labels
    assert np.all(left(seen, start.point) < 0.5 * left(seen, known.shift))


def test_there_is_no_start_that_is_nearer_than_what_is_true(forward, seen):
    truth = seen.runs.origin
    names = [axis.parameter.name for axis in seen.runs.coordinates]
    for name, size in HIDDEN.items():
        truth[names.index(name)] = size
    assert inverse_start(desk(forward), seen, fitted(seen, truth)) is None


def test_a_motion_that_is_fed_in_needs_no_start(tmp_path: Path):
    machine = MjcfForward.of(arm(tmp_path, {"coulomb_friction": "a b"}))
    time, angles = motion(8.0, 1)
    still = {name: np.zeros((len(time), 1)) for name in ("ta", "tb")}
    signals = {"qa": angles[:, :1], "qb": angles[:, 1:], **still}
    record = preprocess(machine, [Recording(time, signals, RecordingInfo("measured"))])
    assert inverse_start(desk(machine), record, fitted(record, record.runs.origin)) is None
