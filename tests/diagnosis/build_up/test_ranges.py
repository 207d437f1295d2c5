"""A linear cause keeps its range: rounding does not bend its column."""

from __future__ import annotations

import numpy as np
from linear import Linear, recorded, seen

from ves_twin.diagnosis.build_up.trials import trials_at

FAINT = 2e-5
"""What a unit of the faint cause adds [N m], as a hand's inertia does beside its weight."""


class Loaded(Linear):
    """A weight of 40 N m at both joints, and a harmonic that is next to nothing."""

    def simulate(self, programme, values, refined=False):
        kinds = [name for name in values if name.startswith("harmonic")]
        return 40.0 + super().simulate(
            programme, values | {name: FAINT * values[name] for name in kinds}, refined
        )


def test_what_is_linear_but_for_rounding_is_linear():
    """Predictions have seven digits: of 40 N m a tenth of a column of 1e-4 N m is rounding."""
    plant = Loaded()
    runs = seen(plant, recorded(plant, {}, 3)).runs
    trials, columns = trials_at(runs, runs.origin, plant.hypotheses)
    found = {t.cause.label: (t, c) for t, c in zip(trials, columns, strict=True)}
    trial, column = found["harmonic@a"]
    assert not trial.bent
    assert np.abs(column).max() < 5.0 * FAINT
    others = {label for label, (t, _) in found.items() if t.bent}
    assert others == set()
