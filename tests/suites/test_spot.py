"""Hidden laws at joints of machines other than the pendulum: scaled to their motion, recorded."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.hidden_law import LAW_KINDS, Acts, draw_law, takes
from ves_twin.suites.law_suite import MACHINE, hidden_kinds
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.spot import PENDULUM, SPEED, Spot, spots_of

WORKSHOP = Path(__file__).parents[2] / "benchmarks" / "workshop"

MACHINES = ("crane", "elbow", "arm")
"""A joint that nothing drives; two motors that move one another; motion fed in."""


@cache
def machine(name: str) -> BlindMjcf:
    return BlindMjcf(Rig.load(str(WORKSHOP / f"{name}.toml")))


@cache
def spots(name: str) -> tuple[Spot, ...]:
    return spots_of(machine(name).forward, machine(name).programme("train"))


def test_the_shipped_pendulum_is_the_unit_of_spots():
    blind = BlindMjcf(Rig.load(MACHINE))
    (own,) = spots_of(blind.forward, blind.programme("train"))
    assert own.columns == PENDULUM.columns
    assert (own.joint, own.effort, own.actuator) == ("joint", 1.0, "drive")
    assert own.speed == pytest.approx(1.0, rel=0.3)
    assert own.travel == pytest.approx(1.0, rel=0.3)


@pytest.mark.parametrize("name", MACHINES)
def test_a_diagnosis_has_the_place_and_the_variable_of_every_hidden_law(name: str):
    places = {place.name: place for place in machine(name).forward.law_places()}
    for kind in hidden_kinds(str(WORKSHOP / f"{name}.toml")):
        for seed in range(5):
            law = draw_law(kind, np.random.default_rng(seed), spots(name))
            assert law.of in {variable.name for variable in places[law.place].variables}


@pytest.mark.parametrize("name", MACHINES)
def test_a_hidden_law_at_any_joint_shows_in_what_is_recorded(name: str):
    blind = machine(name)
    plain = blind.record(BlindRig({}), "train", np.random.default_rng(0))
    sd = np.array([channel.sd for channel in blind.forward.channels])
    for kind in ("random_of_speed", *(k for k in ("angle_ripple",) if takes(spots(name)[0], k))):
        for spot in spots(name):
            law = draw_law(kind, np.random.default_rng(1), [spot])
            rows = blind.record(BlindRig({}, law=law), "train", np.random.default_rng(0))
            columns = [c.signal for c in blind.forward.channels]
            change = [np.std((rows[c] - plain[c])[:, 0]) for c in columns]
            assert np.max(np.array(change) / sd) > 1.0
            if law.acts is Acts.READING:
                assert np.count_nonzero(change) == 1


def test_a_law_bends_within_the_motion_of_its_joint():
    (rail, _) = spots("crane")
    along = machine("crane").forward.visited(machine("crane").programme("train"), {})
    assert np.max(np.abs(along["speed@rail"])) == pytest.approx(SPEED * rail.speed)


def test_a_kind_that_no_joint_takes_is_refused():
    assert not takes(spots("arm")[0], "saturation")
    with pytest.raises(InvalidInputError, match="saturation"):
        draw_law("saturation", np.random.default_rng(0), spots("arm"))
    assert set(hidden_kinds(str(WORKSHOP / "arm.toml"))) == {
        kind for kind, (acts, _, _) in LAW_KINDS.items() if acts in (Acts.SPEED, Acts.POSITION)
    }
