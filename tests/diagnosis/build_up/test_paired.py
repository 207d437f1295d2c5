"""The paired test against closed forms: its loss, the length of its blocks, and its p."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import t, ttest_1samp

from ves_twin.diagnosis.build_up.paired import DEGREES, LONGEST, SHORTEST, loss, paired

ROWS = 2400
WHOLE = np.zeros(ROWS, int)


def remembering(share: float, seed: int = 3) -> np.ndarray:
    """Rows of unit size whose correlation falls by `share` a row: integral time (1+a)/(1-a)/2."""
    white = np.random.default_rng(seed).standard_normal(ROWS)
    return lfilter([np.sqrt(1.0 - share**2)], [1.0, -share], white)


def test_the_loss_is_minus_the_log_density_of_student_s_t_but_for_a_constant():
    errors = np.linspace(-30.0, 30.0, 41)[:, None]
    found = loss(errors, np.array([2.0]))
    density = t.logpdf(errors / 2.0, DEGREES)
    assert found - found[20] == pytest.approx(density[20] - density, abs=1e-9)


@pytest.mark.parametrize("share", [0.94, 0.96])
def test_a_block_spans_five_integral_times_of_the_difference(share):
    blocks = paired(0.1 + remembering(share), WHOLE).blocks
    rows = 5.0 * 0.5 * (1.0 + share) / (1.0 - share)
    # an integral time read off 2400 rows is known to a fifth
    assert ROWS / blocks == pytest.approx(rows, rel=0.35)
    assert SHORTEST * ROWS < rows < LONGEST * ROWS


@pytest.mark.parametrize(("share", "blocks"), [(0.0, 40), (0.999, 12)], ids=["white", "slow"])
def test_a_block_is_a_fortieth_to_a_twelfth_of_all_rows(share, blocks):
    assert paired(remembering(share), WHOLE).blocks == blocks


def test_the_p_is_that_of_a_one_sided_test_of_the_blocks():
    """Of sums about their own mean: one block with all of the gain proves nothing."""
    difference = 0.08 + remembering(0.0)
    told = paired(difference, WHOLE)
    sums = difference.reshape(told.blocks, -1).sum(axis=1)
    assert told.p == pytest.approx(ttest_1samp(sums, 0.0, alternative="greater").pvalue, rel=1e-6)
    assert told.total == pytest.approx(difference.sum())


def test_a_difference_that_never_forgets_has_blocks_all_the_same():
    assert paired(np.full(ROWS, 0.3), WHOLE).p < 1e-6
    assert paired(np.zeros(0), np.zeros(0, int)).blocks == 0
