"""What sizes are weighed by: noise and model error, across channels or each by itself."""

from __future__ import annotations

import numpy as np
import pytest
from toy import Toy, programme

from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.record.runs import Runs


@pytest.fixture(scope="module")
def shared():
    """Runs, and a residual of two channels that mostly goes along (rows, 2)."""
    runs = Runs(Toy(), (programme(1),), (0, 1))
    rng = np.random.default_rng(4)
    common = rng.standard_normal(len(programme(1).time))
    own = rng.standard_normal((len(common), 2))
    return runs, common[:, None] * [1.0, 2.0] + 0.3 * own


def test_channels_that_go_along_are_weighed_together(shared):
    runs, residual = shared
    mixing = discrepancy(runs, residual, memory=False).mixing[0]
    assert abs(mixing[1, 0]) > 0.5 * abs(mixing[0, 0])
    white = discrepancy(runs, residual, memory=False).apply(residual.astype(np.float32))
    alike = np.corrcoef(white.reshape(-1, 2).T)[0, 1]
    assert abs(alike) < 0.35  # 0.95 before; a tenth of the covariance is without correlations


def test_each_channel_by_itself_has_its_size_and_no_other_s_error(shared):
    runs, residual = shared
    mixing = discrepancy(runs, residual, memory=False, shrinkage=1.0).mixing[0]
    assert mixing[1, 0] == mixing[0, 1] == 0.0
    sizes = np.sqrt(np.mean(residual**2, axis=0))
    assert 1.0 / np.diag(mixing) == pytest.approx(sizes, rel=0.02)  # 1 % of white noise is added
