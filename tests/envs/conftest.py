"""Every registered environment in turn, made once a module."""

import pytest
from short_episodes import make_short

from ves_twin.envs import ENVIRONMENTS


@pytest.fixture(scope="module", params=sorted(ENVIRONMENTS))
def env(request):
    """Each environment, bare."""
    made = make_short(request.param)
    yield made.unwrapped
    made.close()
