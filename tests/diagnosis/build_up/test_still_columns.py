"""A column that nothing moves is told as such, and warns of nothing."""

import warnings

from linear import Linear, halves

from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.report import report_of


def test_a_column_of_zeros_goes_along_with_nothing_and_follows_no_law():
    """Two axes of an accelerometer on a slide, say."""
    both = halves(Linear(), {"coulomb@a:size": 0.8}, 51, error=0.02)
    labels = [trial.cause.label for trial in both.regression.trials]
    proof = prove(both.regression, both.held, [labels.index("coulomb@a")])
    left = proof.bench.residual(proof.proved)
    left[:, 1] = 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = report_of(both, proof, (left, left))
    still = report.left["torque.b"]
    assert (still.rms, still.along, still.laws) == (0.0, {}, {})
