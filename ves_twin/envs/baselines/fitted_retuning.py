"""FittedRetuning: the controller tuned on a machine of which every number was fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import final

import numpy as np
from scipy.optimize import least_squares

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.envs.baselines.retuning import Retuning
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

ROUNDS = 40
"""Of the fit; gain, mass and inertia are told apart by little, so that twelve end far from it."""

LOW_HIGH = ("low", "high")

INSIDE = 0.05
"""Of the scale: so far from a bound the search begins, since it creeps where it is close to one."""


@final
class FittedRetuning(Retuning):
    """Identification without a diagnosis: all sizes of the library at once, by least squares.

    Numbers of the machine are held by their tolerances, sizes of causes by their largest ones,
    starts and zeros of each recording by theirs. No cause is preferred to another.
    """

    def twin(self, records: Sequence[Recording]) -> tuple[Rig, Mapping[str, float]]:
        """The believed machine at the fitted values."""
        rig = self.known.task.rig
        forward = MjcfForward.of(rig)
        told = rig.description.rate
        fed = [Excitation.of(record, forward.drive, rate=told) for record in records]
        seen = [
            np.stack([record[c.signal][:, c.column] for c in forward.channels], axis=1)
            for record in records
        ]
        sds = np.array([c.sd for c in forward.channels])
        largest = {n: s for h in forward.hypotheses for n, s in zip(h.parameters, h.largest)}  # noqa: B905
        own = [p for p in forward.parameters if not p.per_recording]
        own = [p for p in own if p.name in largest or p.sd > 0.0]
        days = [p for p in forward.parameters if p.per_recording and p.sd > 0.0]
        every = [*own, *(p for _ in records for p in days)]
        scale = np.array([largest.get(p.name, p.sd) for p in every])
        nominal = np.array([p.nominal for p in every])

        def off(x: FloatArray) -> FloatArray:
            values = nominal + scale * x
            shared = {p.name: float(v) for p, v in zip(own, values, strict=False)}
            rows = [x]
            for k, (excitation, record) in enumerate(zip(fed, seen, strict=True)):
                first = len(own) + k * len(days)
                of_day = zip(days, values[first : first + len(days)], strict=True)
                here = {**shared, **{p.name: float(v) for p, v in of_day}}
                rows.append(((forward.simulate(excitation, here) - record) / sds).ravel())
            return np.concatenate(rows)

        bounds = [(np.array([getattr(p, e) for p in every]) - nominal) / scale for e in LOW_HIGH]
        start = np.clip(np.zeros(len(every)), bounds[0] + INSIDE, bounds[1] - INSIDE)
        found = least_squares(
            off, start, bounds=bounds, method="dogbox", diff_step=1e-3, max_nfev=ROUNDS
        )
        values = nominal + scale * found.x
        return rig, {p.name: float(v) for p, v in zip(own, values, strict=False)}
