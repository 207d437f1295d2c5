"""How often what is not there is proved, over draws of what is hidden."""

from __future__ import annotations

import numpy as np
import pytest
from linear import Linear, drawn, halves
from sizes import nightly_but

from ves_twin.diagnosis.build_up.proof import FALSE_SHARE, prove
from ves_twin.diagnosis.build_up.select import Selector

PLANT = Linear()


def rates(draws: int, count: int) -> tuple[int, int, int]:
    """False and true names that are proved, and hidden ones, over draws."""
    wrong = right = hid = 0
    for seed in range(draws):
        hidden = drawn(np.random.default_rng(100 + seed), count) if count else {}
        two = halves(PLANT, hidden, 50 + seed)
        proof = prove(two.regression, two.held, Selector(two.regression).run())
        names = {f"{two.regression.trials[n].cause.label}:size" for n in proof.proved}
        wrong += len(names - set(hidden))
        right += len(names & set(hidden))
        hid += len(hidden)
    return wrong, right, hid


def test_nothing_is_proved_where_nothing_is_hidden():
    wrong, _, _ = rates(6, 0)
    assert wrong <= 1


@pytest.mark.slow
@pytest.mark.parametrize("count", nightly_but(1, [0, 3, 6]))
def test_the_false_discovery_rate_is_kept_over_draws(count):
    wrong, right, hid = rates(40, count)
    # three sd of a binomial above the rate
    allowed = FALSE_SHARE * max(right + wrong, 40)
    assert wrong <= allowed + 3.0 * np.sqrt(allowed)
    assert right >= 0.85 * hid
