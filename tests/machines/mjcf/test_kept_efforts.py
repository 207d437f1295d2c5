"""What is kept of a motion changes no prediction: a law over every kind on an MJCF machine."""

import numpy as np
import pytest
from two_link import TARGETS, programme, rig

from ves_twin.machines.mjcf import inverse
from ves_twin.machines.mjcf.forward import MjcfForward

ROUND_OFF = 1e-9
"""Of what a cause moves: directions are computed by a departure of a tenth."""


@pytest.fixture(scope="module")
def forward(tmp_path_factory):
    return MjcfForward.of(rig(tmp_path_factory.mktemp("two_link"), mode="motion"))


@pytest.mark.parametrize("kind", TARGETS)
def test_a_motion_that_was_fed_in_before_gives_the_same_efforts(forward, kind):
    fed = programme()
    nominal = forward.simulate(fed, {})
    for cause in (c for c in forward.hypotheses if c.effect == kind):
        sizes = 0.5 * cause.signs[-1] * np.array(cause.largest)
        values = {
            p.name: p.nominal + size
            for name, size in zip(cause.parameters, sizes, strict=True)
            for p in forward.parameters
            if p.name == name
        }
        kept = forward.simulate(fed, values)
        inverse._efforts.cache_clear()
        alone = forward.simulate(fed, values)
        assert np.max(np.abs(kept - alone)) <= ROUND_OFF * max(np.max(np.abs(alone - nominal)), 1.0)
        forward.simulate(fed, {})
