"""What is kept of a motion changes no prediction: a law over every kind on an MJCF machine."""

from dataclasses import replace

import numpy as np
import pytest
from two_link import TARGETS, programme, rig

from ves_twin.machines.mjcf.motion import inverse, thinned
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.kept_efforts import IDLE, KeptEfforts
from ves_twin.machines.mjcf.parts import rigid_efforts

ROUND_OFF = 1e-9
"""Of what a cause moves: directions are computed by a departure of a tenth."""


class Direct:
    """In the place of sums: every model by itself."""

    linear = False

    def __init__(self, *_):
        pass


@pytest.fixture(scope="module")
def forward(tmp_path_factory):
    return MjcfForward.of(rig(tmp_path_factory.mktemp("two_link"), mode="motion"))


def forget():
    inverse._efforts.cache_clear()
    inverse._moved.cache_clear()


SUMMED = {"payload", "mass_centre", "body_mass", "body_inertia", "rotor_inertia", "joint_spring"}
SUMMED |= {"joint_compliance"}
"""Kinds whose efforts are sums of directions."""


@pytest.mark.parametrize("kind", TARGETS)
def test_a_motion_that_was_fed_in_before_gives_the_same_efforts(forward, kind, monkeypatch):
    fed = programme()
    forget()
    nominal = forward.simulate(fed, {})
    causes = [c for c in forward.hypotheses if c.effect == kind]
    assert causes
    for cause in causes:
        sizes = 0.5 * cause.signs[-1] * np.array(cause.largest)
        known = {p.name: p.nominal for p in forward.parameters}
        values = {n: known[n] + size for n, size in zip(cause.parameters, sizes, strict=True)}
        kept = forward.simulate(fed, values)
        if kind in SUMMED:
            assert inverse._moved.cache_info().currsize == 0
        forget()
        assert np.array_equal(kept, forward.simulate(fed, values))
        forget()
        with monkeypatch.context() as patched:
            patched.setattr(inverse, "RigidEfforts", Direct)
            direct = forward.simulate(fed, values)
        forget()
        change = np.max(np.abs(direct - nominal))
        assert np.max(np.abs(kept - direct)) <= ROUND_OFF * max(change, 1.0)
        forward.simulate(fed, {})


MANY = 70
"""Recordings of one fit: more than were once kept."""


def counted(forward, recordings, monkeypatch):
    """Passes of inverse dynamics of a second round, and what each round predicts."""
    passes, own = [], rigid_efforts.inverted
    for module in (rigid_efforts, inverse, thinned):
        monkeypatch.setattr(module, "inverted", lambda *args: passes.append(1) or own(*args))
    (mass,) = (p for p in forward.parameters if p.name == "body_mass@arm:mass")
    values, rounds = {mass.name: 1.1 * mass.nominal}, []
    for _ in range(2):
        passes.clear()
        rounds.append(np.array([forward.simulate(fed, values) for fed in recordings]))
    return len(passes), rounds


def short(rows=30):
    """As many recordings, each a little other than the one before."""
    fed = programme()
    drive = {name: column[:rows] for name, column in fed.drive.items()}
    return [
        replace(fed, time=fed.time[:rows], drive={n: c + 1e-3 * k for n, c in drive.items()})
        for k in range(MANY)
    ]


def test_a_second_round_of_many_recordings_costs_no_pass(forward, monkeypatch):
    forget()
    passes, rounds = counted(forward, short(), monkeypatch)
    assert passes == 0
    assert np.array_equal(*rounds)


def test_without_room_the_first_ones_stay_and_predictions_are_the_same(forward, monkeypatch):
    forget()
    _, kept = counted(forward, short(), monkeypatch)
    forget()
    size = rigid_efforts.size_of(forward.rig.model, 30)
    monkeypatch.setattr(inverse, "KeptEfforts", lambda: KeptEfforts(10.5 * size))
    passes, rounds = counted(forward, short(), monkeypatch)
    assert 0 < passes <= MANY - 10
    assert rounds[1] == pytest.approx(kept[1], rel=ROUND_OFF, abs=ROUND_OFF)


def test_motions_of_an_earlier_diagnosis_make_room_and_those_of_this_one_stay():
    kept, made = KeptEfforts(3.0), []

    def of(motion):
        return kept.of(motion, 1, lambda: made.append(motion) or motion)

    assert [of(day) for day in ("a", "b", "c")] == ["a", "b", "c"]
    assert of("d") is None
    for _ in range(IDLE * 3):
        assert of("c") == "c"
    assert (of("d"), of("e"), of("f")) == ("d", "e", None)
    assert made == ["a", "b", "c", "d", "e"]
