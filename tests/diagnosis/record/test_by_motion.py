"""A plant by its inverse dynamics: what a motion lacks, whatever the plant weighs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lively_arm import lively, measured

from ves_twin.diagnosis.record.by_motion import by_motion, missing_at
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.motion.forward import MjcfForward

LEVEL = "coulomb_friction@a:level"
MASSES = ("body_mass@one:mass", "body_mass@two:mass")


@pytest.fixture(scope="module")
def forward(tmp_path_factory: pytest.TempPathFactory) -> MjcfForward:
    return MjcfForward.of(lively(tmp_path_factory.mktemp("lively")))


def seen(forward: MjcfForward, values: dict[str, float]) -> Dataset:
    return preprocess(forward, [measured(forward.rig, values, 4.0, 1)])


def rms(told: Dataset, rows: np.ndarray) -> np.ndarray:
    """Of what is missing at each joint."""
    return np.sqrt(np.mean(np.square(rows), axis=0, where=told.runs.kept))


def moved(told: Dataset, name: str, size: float) -> np.ndarray:
    """A point where one parameter departs."""
    point = told.runs.origin
    names = [axis.parameter.name for axis in told.runs.coordinates]
    point[names.index(name)] = size
    return point


def test_a_plant_that_is_right_lacks_what_noise_makes_of_its_accelerations(forward):
    """2 mrad behind 10 Hz are some 3 rad/s^2, 0.05 N m of the first link's inertia."""
    told = by_motion(seen(forward, {}))
    assert told is not None
    assert np.all(rms(told, told.runs.one(told.runs.origin)) < 0.1)
    assert np.all(told.measured == 0.0)


def test_friction_that_a_motion_has_is_missing_at_its_joint_until_it_is_there(forward):
    told = by_motion(seen(forward, {LEVEL: 0.15}))
    names = [channel.name for channel in told.runs.forward.channels]
    own = names.index(missing_at("a"))
    without = rms(told, told.runs.one(told.runs.origin))[own]
    there = rms(told, told.runs.one(moved(told, LEVEL, 0.15)))[own]
    assert there < 0.6 * without
    assert there < rms(told, told.runs.one(moved(told, LEVEL, 0.3)))[own]


@pytest.mark.parametrize(
    ("of", "slope"), [("speed@a", -0.06), ("position@a", -0.5), ("command@motor", 0.5)]
)
def test_a_law_is_missing_until_it_is_there(forward, of, slope):
    span = (-20.0, 20.0)
    law = Law("a", LawKind.EFFORT, LawShape.TABLE, (of,), (span,), (slope * -20.0, slope * 20.0))
    told = by_motion(preprocess(forward, [measured(forward.rig, {}, 4.0, 1, laws=[law])]))
    assert told is not None
    runs, plant = told.runs, told.runs.forward
    without, there = (
        rms(told, plant.simulate(runs.programmes[0], {}, laws=laws)) for laws in ([], [law])
    )
    assert there[0] < 0.6 * without[0]
    assert [place.name for place in plant.law_places()] == ["a", "b"]


@pytest.mark.parametrize("name", MASSES)
def test_a_lighter_plant_lacks_no_less_for_noise(forward, name):
    """Efforts of its own masses would fall with them: half the mass, half the noise."""
    told = by_motion(seen(forward, {}), as_nominal=True)
    (mass,) = (p.nominal for p in forward.parameters if p.name == name)
    light = rms(told, told.runs.one(moved(told, name, -0.45 * mass)))
    assert np.all(light > 0.9 * rms(told, told.runs.one(told.runs.origin)))


def test_rows_near_an_end_or_without_a_measurement_do_not_count(forward):
    record = seen(forward, {})
    holes = np.zeros_like(record.measured, bool)
    holes[200:210, 1] = True
    told = by_motion(replace(record, runs=replace(record.runs, holes=(holes,))))
    kept = told.runs.kept
    assert not kept[:9].any()
    assert not kept[-9:].any()
    assert not kept[200:210].any()
    assert kept[100:200].all()


def test_a_limit_that_is_at_work_tells_nothing(tmp_path: Path):
    stopped = MjcfForward.of(lively(tmp_path, 'limited="true" range="-10 10"'))
    assert by_motion(seen(stopped, {})) is None
