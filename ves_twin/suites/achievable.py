"""true_energy: mean z^2 that the true values leave of a held-out recording."""

from __future__ import annotations

from collections.abc import Mapping

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.forward import Forward
from ves_twin.diagnosis.metric import Metric
from ves_twin.diagnosis.preprocess import preprocess
from ves_twin.diagnosis.whitening import whitening_of


def true_energy(
    forward: Forward, held_out: Recording, standstill: Recording, values: Mapping[str, float]
) -> float:
    """What no model of this library can fall below: noise, and what it lacks.

    The step of the forward is not the rig's: its trace is taken off as a diagnosis takes it off.

    Args:
        forward: the model that was held against the recording.
        held_out: the recording.
        standstill: tells the noise.
        values: every value of the rig, by parameter.
    """
    runs = preprocess(forward, [held_out]).runs
    measured = preprocess(forward, [held_out]).measured
    shift = runs.origin
    for i, axis in enumerate(runs.coordinates):
        shift[i] = values.get(axis.parameter.name, axis.parameter.nominal) - axis.parameter.nominal
    coarse, fine = runs.one(shift), runs.one(shift, refined=True)
    plain = whitening_of(runs, standstill)
    first = Metric(2.0 * plain.apply((fine - coarse)[None]).T)
    own = plain.adapted(first.project(plain.apply(measured - coarse)))
    left = Metric(2.0 * own.apply((fine - coarse)[None]).T).project(own.apply(measured - coarse))
    return float(left @ left) / len(left)
