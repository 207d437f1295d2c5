"""Of a cause that bends the ends of its range are tried, too; of a straight one a single size."""

import pytest

from tests.diagnosis.build_up.linear import Linear, motion
from ves_twin.diagnosis.build_up.trials import trials_at
from ves_twin.diagnosis.runs import Runs


@pytest.mark.parametrize(("kind", "several"), [("viscous", False), ("gap", True)])
def test_a_cause_that_bends_is_tried_up_to_the_end_of_its_range(kind, several):
    plant = Linear(kinds=(kind,))
    runs = Runs(plant, (motion(1),), (0, 1))
    trials, _ = trials_at(runs, runs.origin, plant.hypotheses)
    for cause in plant.hypotheses:
        sizes = [trial.sizes[0] for trial in trials if trial.cause == cause]
        assert (len(sizes) > 1) == several
        assert (max(sizes) == pytest.approx(cause.largest[0])) == several
