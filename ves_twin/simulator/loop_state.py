"""LoopState: everything the next tick depends on, as one vector of small departures from rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.plant.physics.delay import PASTS
from ves_twin.simulator.computers import ComputersSnapshot
from ves_twin.simulator.simulator import Simulator

STEP = 1e-6
"""Relative step of the differences: far above round-off, far below any nonlinearity."""

_SPOOLS = ("spool", "current", "valve_command", "sent", "current_past")
_SCRATCH = "work"


class LoopState:
    """Tangent coordinates of the whole sampled loop about the rest of a simulator.

    In order: displacements and speeds of the mechanics, what the gravity estimate sees of them
    (one tick old), every number of the compiled state, the board, the controller's state and the
    gravity estimates in shared memory.

    Args:
        sim: a simulator at its rest.
        opening: step of spool openings.

    Attributes:
        steps: step of the differences in each coordinate (n,).
        displacements: the coordinates that are displacements of the mechanics.

    Raises:
        InvalidInputError: a controller whose snapshot is not an array.
    """

    def __init__(self, sim: Simulator, opening: float) -> None:
        rig = sim.rig
        self._sim, self._rest = sim, sim.snapshot()
        self._qpos = rig.data.qpos.copy()
        self._warm = rig.data.qacc_warmstart.copy()
        names = ["velocity"] * (2 * rig.model.nv) + ["truth"] * 15
        live = [
            rig.data.qvel,
            rig.data.subtree_com[rig.layout.sensor_body],
            rig.data.site_xpos[rig.layout.sensor_site],
            rig.data.site_xmat[rig.layout.sensor_site],
            *self._numbers(names),
        ]
        self._live = tuple(live)
        memory = self._memory(sim.computers.snapshot())
        names += ["memory"] * len(memory)
        self._values = np.concatenate([*self._live, memory])
        size = np.concatenate([np.zeros(rig.model.nv), self._values])
        spool = np.array([name in _SPOOLS for name in names])
        self.steps = np.where(spool, opening, STEP * np.maximum(1.0, np.abs(size)))
        self.displacements = slice(0, rig.model.nv)

    def jacobian(self, advance: Callable[[], None]) -> FloatArray:
        """Centred differences d(after) / d(before) of one advance of the simulator (n, n)."""
        n = len(self.steps)
        result = np.empty((n, n))
        departure = np.zeros(n)
        for j in range(n):
            departure[j] = self.steps[j]
            self._write(departure)
            advance()
            ahead = self._read()
            departure[j] = -self.steps[j]
            self._write(departure)
            advance()
            result[:, j] = (ahead - self._read()) / (2.0 * self.steps[j])
            departure[j] = 0.0
        self._sim.restore(self._rest)
        return result

    def _numbers(self, names: list[str]) -> Iterator[FloatArray]:
        """Live views of every float of the compiled state and of the board; adds their names."""
        late = self._sim.rig.parameters["late"]
        absent = {past for line in PASTS if not late[line]["kept"][0] for past in PASTS[line]}
        for block in (self._sim.rig.state, self._sim.rig.board.block):
            flat = block.view(np.float64)
            for name, first, count in _floats(block.dtype, 0, absent | {_SCRATCH}):
                names += [name] * count
                yield flat[first : first + count]

    def _write(self, departure: FloatArray) -> None:
        """Put the simulator at rest plus a departure."""
        sim, data, nv = self._sim, self._sim.rig.data, self._sim.rig.model.nv
        data.qpos[:] = self._qpos
        mujoco.mj_integratePos(sim.rig.model, data.qpos, departure[:nv], 1.0)
        data.qacc_warmstart[:] = self._warm
        values = self._values + departure[nv:]
        at = 0
        for view in self._live:
            view[:] = values[at : at + len(view)]
            at += len(view)
        self._remember(values[at:])

    def _read(self) -> FloatArray:
        """Departure of the simulator from its rest (n,)."""
        rig = self._sim.rig
        moved = np.empty(rig.model.nv)
        mujoco.mj_differentiatePos(rig.model, moved, 1.0, self._qpos, rig.data.qpos)
        memory = self._memory(self._sim.computers.snapshot())
        return np.concatenate([moved, np.concatenate([*self._live, memory]) - self._values])

    def _memory(self, snapshot: ComputersSnapshot) -> FloatArray:
        """State of controller and gravity compensation, and the estimates in shared memory."""
        parts = []
        for what, part in (("controller", snapshot.controller), ("gravity", snapshot.gravity)):
            if part is None:
                continue
            if not isinstance(part, np.ndarray) or part.dtype != np.float64 or part.ndim != 1:
                kind = type(part).__name__
                raise InvalidInputError(f"state of the {what}", kind, "an array of numbers or none")
            parts.append(part)
        return np.concatenate([*parts, *snapshot.shared])

    def _remember(self, values: FloatArray) -> None:
        rest = self._rest.computers
        parts: list[object] = []
        at = 0
        for part in (rest.controller, rest.gravity):
            size = len(part) if isinstance(part, np.ndarray) else 0
            parts.append(values[at : at + size].copy() if size else part)
            at += size
        shared = tuple(np.split(values[at:].copy(), len(rest.shared)))
        self._sim.computers.restore(ComputersSnapshot(parts[0], parts[1], shared, rest.feedforward))


def _floats(
    dtype: np.dtype[np.void], offset: int, absent: set[str]
) -> Iterator[tuple[str, int, int]]:
    """Name, first index and count of every float leaf of a structured type that is not absent."""
    fields: Mapping[str, Any] = dtype.fields or {}
    for name in (n for n in fields if n not in absent):
        inner, start = fields[name][:2]
        base = inner.base if inner.subdtype else inner
        if base.names:
            yield from _floats(base, offset + start, absent)
        elif base == np.float64:
            yield name, (offset + start) // 8, inner.itemsize // 8
