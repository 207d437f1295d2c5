"""differential: a record against recordings of the same rig in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import linearise, with_bends
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.model.forward import Excitation, Forward, Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.record.baseline import usual_rows
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.unmodelled_dynamics import CHANGE, PARAMETERS, Lacking
from ves_twin.diagnosis.record.whitening import Whitening

KEPT = 0.3
"""Share of a commissioning sd that a rig is allowed to change by between two recordings."""


@dataclass(frozen=True)
class Differential:
    """A record with what the model always gets wrong taken off, and the model tuned to this rig.

    Attributes:
        seen: the record, about the tuned model.
        noise: sd of its noise against that of one recording.
        differs: largest difference of the baseline's inputs from the record's, of their range.
    """

    seen: Dataset
    noise: float
    differs: float


def differential(
    seen: Dataset,
    baseline: Sequence[Recording],
    again: Callable[[Forward], Dataset],
    whitening: Whitening,
) -> Differential:
    """Tune the commissioning parameters on the baseline, and take what then stays off the record.

    A rig has structure that its model lacks: ripple, floor, play. A recording of the same
    programme, made while the rig was in order, shows it: r = y_b - f(nu_b). Of y - r about f(nu_b)
    stays what has changed since, and noise of 1 + 1/n the variance. What is drawn anew for each
    recording, as a zero, is not tuned; its difference has 1 + 1/n the variance, too.
    What the model lacks acts otherwise where a fault moves the rig otherwise: r, and what tuning
    took for it, may change by a share.

    Args:
        seen: the record that is diagnosed.
        baseline: recordings of the same rig in order, some for each programme of the record.
        again: observes the record by another forward.
        whitening: noise.

    Raises:
        InvalidInputError: a programme without a baseline.
    """
    runs = seen.runs
    found = usual_rows(seen, baseline)
    rows, count = found.rows, found.count
    local = with_bends(linearise(runs, runs.origin))
    fit = refine(Evidence(runs, rows, whitening), (), runs.origin, local, 1)
    noise = float(np.sqrt(1.0 + 1.0 / count))
    own = Tuned.to(runs, fit.shift, noise)
    tuned = again(own)
    step = np.float32(fit.step_share) * fit.local.columns[-1]
    usual = rows - tuned.runs.one(tuned.runs.origin) - step
    traces = Lacking.of(tuned.runs, usual)
    free = again(replace(own, lacking=traces))
    return Differential(replace(free, measured=free.measured - usual), noise, found.differs)


@dataclass(frozen=True)
class Tuned(ForwardWrapper):
    """A forward whose commissioning parameters were found on its own rig.

    Departures count from the rig's own values.

    Attributes:
        tuned: its parameters with those of the rig as nominal, and KEPT of their sd, or CHANGE of
            what they were tuned by if that is more: it stands for what the model lacks.
        lacking: traces that may grow and turn, by programme.
    """

    tuned: tuple[Parameter, ...]
    lacking: tuple[Lacking, ...] = ()

    @staticmethod
    def to(runs: Runs, shift: FloatArray, noise: float) -> Tuned:
        """To departures fitted with a forward's runs; `noise` widens what each recording draws."""
        moved = {
            axis.parameter.name: float(shift[i])
            for i, axis in enumerate(runs.coordinates)
            if axis.recording < 0
        }
        parameters = tuple(
            replace(
                p,
                nominal=p.nominal + moved[p.name],
                sd=max(KEPT * p.sd, CHANGE * abs(moved[p.name])) if p.sd > 0.0 else 0.0,
            )
            if p.name in moved
            else replace(p, sd=noise * p.sd)
            for p in runs.forward.parameters
        )
        return Tuned(runs.forward, parameters)

    @property
    def identity(self) -> str:
        """Of the forward, the values and the traces."""
        traces = (trace.programme.encode() + trace.traces.tobytes() for trace in self.lacking)
        return self.identified(f"{[(p.nominal, p.sd) for p in self.parameters]}", b"".join(traces))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The tuned ones, and what the lacking physics may do."""
        return (*self.tuned, *PARAMETERS) if self.lacking else self.tuned

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """As the forward, at the rig's own values where nothing else is said."""
        own = {p.name: p.nominal for p in self.tuned if not p.per_recording} | dict(values)
        sizes = np.array([own.pop(p.name, 0.0) for p in PARAMETERS])
        rows = self.forward.simulate(programme, own, refined)
        for trace in self.lacking:
            if trace.programme == programme.identity:
                rows = rows + np.tensordot(sizes, trace.traces, axes=1)
        return rows
