"""What is kept of a motion changes no prediction: a law over every kind on an MJCF machine."""

import numpy as np
import pytest
from two_link import TARGETS, programme, rig

from ves_twin.machines.mjcf.motion import inverse
from ves_twin.machines.mjcf.motion.forward import MjcfForward

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
