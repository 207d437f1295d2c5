"""Every environment with a rig in turn, made once a module."""

import pytest
from short_episodes import make_short

from ves_twin.envs import RIG_ENVIRONMENTS


@pytest.fixture(scope="module", params=sorted(RIG_ENVIRONMENTS))
def env(request):
    """Each environment, bare."""
    made = make_short(request.param)
    yield made.unwrapped
    made.close()
