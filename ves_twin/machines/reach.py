"""tolerance_reach: how far a machine in order may lie from its model in one recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from ves_twin.core.errors import VesTwinError
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.envelope import envelope_sd
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.machines.diagnose import prepare
from ves_twin.machines.machine import Machine, Material, Named
from ves_twin.scenario.experiment_file import ExperimentFile


@dataclass(frozen=True)
class Reach:
    """Sd of what a machine in order shows about the prediction, of noise and tolerances.

    Attributes:
        time: rows of the analysis grid [s] (m,).
        sd: by column, in its unit (m,).
    """

    time: FloatArray
    sd: Mapping[str, FloatArray]


def tolerance_reach(
    machine: Machine,
    given: Named,
    experiment: ExperimentFile | None,
    patience: float,
    progress: Callable[[float, str], None],
) -> Reach | str:
    """The reach of a recording, linear in the tolerances, by two simulations for each.

    Args:
        machine: with declared tolerances.
        given: the recording.
        experiment: how it was made.
        patience: time that it may take [s].
        progress: told how far it is.

    Returns:
        It; or a sentence that says why there is none.
    """
    try:
        prepared = prepare(machine, Material((given,)), experiment)
        forward = prepared.machine.forward
        recording = prepared.material.measured[0].recording
        seen = preprocess(forward, prepared.machine.pieces(recording))
        begin = perf_counter()
        seen.runs.one(seen.runs.origin)
        needed = (2 * len(seen.runs.nuisances) + 1) * (perf_counter() - begin)
        if needed > patience:
            return f"no tolerance envelope: it takes about {needed:.0f} s; ask with --envelope"
        base = linearise(seen.runs, seen.runs.origin, progress)
    except VesTwinError as error:
        return f"no tolerance envelope: {error}"
    sd = envelope_sd(base).astype(float)
    names = [forward.channels[c].name for c in seen.runs.columns]
    columns = {name: sd[:, c] for c, name in enumerate(names)}
    time = np.concatenate(seen.runs.times)
    order = np.argsort(time, kind="stable")  # a piece begins in the one before, by its lead
    return Reach(time[order], {name: column[order] for name, column in columns.items()})
