"""SignatureLibrary: the change each hypothesis makes at finite sizes, for a plant and inputs."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.types import BoolArray, FloatArray, IntArray, SingleArray
from ves_twin.core.whole_file import whole_file
from ves_twin.diagnosis.bank.linearise import Linearisation, linearise, with_bends
from ves_twin.diagnosis.bank.rungs import rungs
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.runs import Progress, Runs, silent

STRAIGHT = 4.0
"""Size of a linear signature in commissioning sd; scaled, it reaches from 1.4 to 11."""

LADDER = 6.0
"""Step between the sizes of a cause that is linear throughout; scaling bridges a factor of 8."""

SAME = 1e-2
"""Sd of one sample by which a kept prediction may be off: rounding of another processor."""

SCHEMA = 6
"""Version of the cached file; another one is built anew."""


@dataclass(frozen=True)
class SignatureLibrary:
    """Signatures s_k = f(e_k) - f(0) at finite sizes, and the linearisation at nominal.

    Derivatives at nominal would miss friction, deadband and everything one-sided.

    Each entry is a shape times a factor: a column of the base where the cause is a commissioning
    parameter too and proportional to it, else a shape of its own.

    Attributes:
        base: prediction and nuisance columns where nothing departs.
        hypotheses: the library.
        owner: hypothesis of each entry (entries,).
        sizes: departure of the hypothesis's parameters of each entry.
        shape: which shape each entry is: columns of the base first, then `bent` (entries,).
        factor: of that shape (entries,).
        bent: change of the channels of those that are no multiple of a column (b, rows, c).
    """

    base: Linearisation
    hypotheses: tuple[Hypothesis, ...]
    owner: IntArray
    sizes: tuple[FloatArray, ...]
    shape: IntArray
    factor: FloatArray
    bent: SingleArray

    def entries(self, hypothesis: int) -> IntArray:
        """Entries of one hypothesis."""
        return np.flatnonzero(self.owner == hypothesis)

    def signature(self, entry: int) -> SingleArray:
        """Change of the channels of one entry (rows, c)."""
        own = int(self.shape[entry]) - len(self.base.columns)
        shape = self.base.columns[own] if own < 0 else self.bent[own]
        return np.asarray(np.float32(self.factor[entry]) * shape)

    def without(self, labels: tuple[str, ...]) -> SignatureLibrary:
        """The bank with some causes left out, by effect or by effect@target."""
        kept = [
            i
            for i, h in enumerate(self.hypotheses)
            if h.effect not in labels and h.label not in labels
        ]
        rows = np.flatnonzero(np.isin(self.owner, kept))
        return replace(
            self,
            hypotheses=tuple(self.hypotheses[i] for i in kept),
            owner=np.searchsorted(np.array(kept, int), self.owner[rows]),
            sizes=tuple(self.sizes[i] for i in rows),
            shape=self.shape[rows],
            factor=self.factor[rows],
        )


def build_bank(
    runs: Runs,
    point: FloatArray | None = None,
    hypotheses: tuple[Hypothesis, ...] | None = None,
    progress: Progress = silent,
    base: Linearisation | None = None,
    sparse: bool = False,
) -> SignatureLibrary:
    """Simulate every hypothesis at its finite sizes.

    Args:
        runs: of which plant and programmes.
        point: departures to start from; nominal if None. At a fitted first cause this is the
            bank that looks for a second one.
        hypotheses: the library; that of the forward if None.
        progress: told how far it is.
        base: linearisation there, if it is known.
        sparse: fewer runs, for a machine of many parameters: most sizes are scaled from another,
            and like tolerances tell together how far they bend.

    Returns:
        The bank, without entries that bounds leave near the starting point or that diverge.

    Raises:
        InvalidInputError: the plant fails at the starting point itself.
    """
    start = runs.origin if point is None else point
    library = runs.forward.hypotheses if hypotheses is None else hypotheses
    if base is None:
        base = with_bends(linearise(runs, start, progress), progress, sparse)
    if not np.all(np.isfinite(base.prediction)):
        came = "set-points at which the plant leaves its limits"
        raise InvalidInputError("programme", came, "one that the nominal plant carries out")
    climbs = [
        _Climb.of(runs, start, h, hypothesis, sparse)
        for h, hypothesis in enumerate(library)
        if not (hypothesis.linear and len(_columns(runs, hypothesis)) == 1)
    ]
    shifts = [end for climb in climbs for end in climb.ends]
    stacks = runs.many(shifts, progress, "signatures") - base.prediction
    found, shapes = _Entries([], [], [], []), list[SingleArray]()
    for climb in climbs:
        own, stacks = stacks[: len(climb.ends)], stacks[len(climb.ends) :]
        climb.add(found, shapes, own, base)
    straight = _straight(base, library)
    rows = len(base.prediction)
    return SignatureLibrary(
        base,
        library,
        np.array([*found.owner, *straight.owner], int),
        (*found.sizes, *straight.sizes),
        np.array([*found.shape, *straight.shape], int),
        np.array([*found.factor, *straight.factor], float),
        np.array(shapes, np.float32).reshape(-1, rows, len(runs.columns)),
    )


@dataclass(frozen=True)
class _Entries:
    """Entries of a bank: owner, departure, shape and factor of each."""

    owner: list[int]
    sizes: list[FloatArray]
    shape: list[int]
    factor: list[float]

    def add(self, owner: int, sizes: FloatArray, shape: int, factor: float) -> None:
        """One more."""
        self.owner.append(owner)
        self.sizes.append(sizes)
        self.shape.append(shape)
        self.factor.append(factor)


@dataclass(frozen=True)
class _Climb:
    """The sizes of one cause from a point: which are simulated, and what entries they make.

    Attributes:
        hypothesis: number in the library.
        moved: departures whose traces are told, as bounds let them: simulated ones, then one sd of
            each parameter that has a column of the base (m, parameters).
        reached: which of those that are simulated bounds leave far enough from the point.
        ends: points that are simulated.
        known: rows of those columns.
        weights: of traces in each entry (k, m).
        room: farthest departures to either side that bounds let (2, parameters).
    """

    hypothesis: int
    moved: FloatArray
    reached: BoolArray
    ends: list[FloatArray]
    known: IntArray
    weights: FloatArray
    room: FloatArray

    @staticmethod
    def of(
        runs: Runs, start: FloatArray, number: int, hypothesis: Hypothesis, sparse: bool
    ) -> _Climb:
        where = runs.indices(hypothesis)
        asked = hypothesis.departures()
        weights, known = np.eye(len(asked)), np.zeros(0, int)
        if sparse:
            crowd = Counter(h.kind for h in runs.forward.hypotheses)[hypothesis.kind]
            known = _columns(runs, hypothesis)
            asked, weights = rungs(hypothesis, crowd, runs.sd[where[: len(known)]])
        ends = [runs.depart(start, where, start[where] + row) for row in asked]
        moved = np.array([end[where] - start[where] for end in ends]).reshape(asked.shape)
        reached = np.any(np.abs(moved) > 0.5 * np.abs(asked), axis=1)
        room = np.array([runs.low[where], runs.high[where]]) - start[where]
        ends = [ends[n] for n in np.flatnonzero(reached)]
        moved = np.concatenate([moved, np.diag(runs.sd[where])[: len(known)]])
        return _Climb(number, moved, reached, ends, known, weights, room)

    def add(
        self, found: _Entries, shapes: list[SingleArray], own: SingleArray, base: Linearisation
    ) -> None:
        """Its entries, of traces without those that bounds left out; none of what diverges."""
        stacks, columns = np.concatenate([own, base.columns[self.known]]), len(base.columns)
        place = np.full(len(self.moved), -1)
        place[: len(self.reached)][self.reached] = np.arange(len(own))
        place[len(self.reached) :] = len(own) + np.arange(len(self.known))
        for n, at in enumerate(place):
            good = at >= 0 and np.all(np.isfinite(stacks[at]))
            place[n] = at if good else -1
        shape = {len(self.reached) + k: int(row) for k, row in enumerate(self.known)}
        for weights in self.weights:
            used = np.flatnonzero(weights)
            sizes = weights @ self.moved
            held = np.clip(sizes, *self.room)
            if np.any(place[used] < 0) or not np.any(np.abs(held) > 0.5 * np.abs(sizes)):
                continue
            if len(used) > 1:
                mixed = np.tensordot(weights[used].astype(np.float32), stacks[place[used]], axes=1)
                found.add(self.hypothesis, sizes, columns + len(shapes), 1.0)
                shapes.append(mixed)
                continue
            n = int(used[0])
            if n not in shape:
                shape[n] = columns + len(shapes)
                shapes.append(stacks[place[n]])
            found.add(self.hypothesis, sizes, shape[n], float(weights[n]))


def _straight(base: Linearisation, library: tuple[Hypothesis, ...]) -> _Entries:
    """Linear signatures of causes that are commissioning parameters too.

    Where a tolerance bends the prediction by more than noise, the finite signature holds what its
    own nuisance column cannot explain, though a strong commissioning error would bend as well. A
    record corrected for that is linear, and only the column itself fits it.
    """
    runs, found = base.runs, _Entries([], [], [], [])
    for h, hypothesis in enumerate(library):
        rows = _columns(runs, hypothesis)
        if len(rows) != 1:
            continue
        sd = runs.sd[runs.nuisances[rows]]
        for spreads in _ladder(hypothesis, float(sd[0])):
            for sign in hypothesis.signs:
                found.add(h, sign * spreads * sd, int(rows[0]), sign * spreads)
    return found


def _columns(runs: Runs, hypothesis: Hypothesis) -> IntArray:
    """Rows of the nuisances that are a cause's parameters, in their order; none if one is none."""
    rows = {int(i): row for row, i in enumerate(runs.nuisances)}
    own = [rows.get(int(i)) for i in runs.indices(hypothesis)]
    return np.array([] if None in own else own, int)


def _ladder(hypothesis: Hypothesis, sd: float) -> list[float]:
    """Sizes in commissioning sd: one, or of a cause linear throughout as many as reach its largest.

    The last rung tells whether the recording would show even the largest size.
    """
    sizes, largest = [STRAIGHT], hypothesis.largest[0] / sd
    while hypothesis.linear and sizes[-1] < largest:
        sizes.append(min(LADDER * sizes[-1], largest))
    return sizes


def cached_bank(
    runs: Runs, folder: Path | None, build: Callable[[], SignatureLibrary], sort: str = ""
) -> SignatureLibrary:
    """The bank of a plant and its programmes from a file, built and written where none holds.

    Args:
        runs: of which plant and programmes.
        folder: of the file; none is kept if None.
        build: makes it.
        sort: of bank, where it is not the full one.

    Raises:
        FileAccessError: the folder cannot be written.
    """
    if folder is None:
        return build()
    path = folder / f"bank-{bank_key(runs, sort.encode())}.npz"
    kept = _read(path, runs)
    if kept is not None and still_predicts(runs, kept.base.prediction):
        return kept
    bank = build()
    write_arrays(
        path,
        prediction=bank.base.prediction,
        columns=bank.base.columns,
        bends=bank.base.bends,
        owner=bank.owner,
        sizes=np.concatenate([*bank.sizes, np.zeros(0)]),
        shape=bank.shape,
        factor=bank.factor,
        bent=bank.bent,
    )
    return bank


def still_predicts(runs: Runs, prediction: SingleArray) -> bool:
    """Whether the forward still predicts what it did when a file was written.

    No key can know that a line of code has changed; one run of the nominal plant does.

    Args:
        runs: whose nominal prediction is made.
        prediction: channels at no departure, as stored (rows, c).
    """
    sds = np.array([runs.forward.channels[c].sd for c in runs.columns])
    off = np.abs(runs.one(runs.origin) - prediction) / sds
    return bool(np.all(off < SAME))


def bank_key(runs: Runs, more: bytes = b"") -> str:
    """Hash of the forward's identity, the programmes, the channels and whatever else counts."""
    parts = [str(SCHEMA), runs.forward.identity, *(p.identity for p in runs.programmes)]
    parts += [str(column) for column in runs.columns]
    return hashlib.sha256("/".join(parts).encode() + more).hexdigest()[:16]


def write_arrays(path: Path, **arrays: np.ndarray[Any, Any]) -> None:
    """Write a file whole or not at all, also when two programs write it at once.

    Raises:
        FileAccessError: the folder cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from None
    with whole_file(path) as partial, partial.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]


def read_arrays(path: Path) -> dict[str, np.ndarray[Any, Any]] | None:
    """What `write_arrays` wrote; None where there is no file, or one that is damaged."""
    try:
        with np.load(path) as content:
            return dict(content)
    except (OSError, ValueError, EOFError, BadZipFile):
        return None


def _read(path: Path, runs: Runs) -> SignatureLibrary | None:
    content = read_arrays(path)
    if content is None:
        return None
    owner = content["owner"]
    widths = [len(runs.forward.hypotheses[i].parameters) for i in owner]
    sizes = tuple(np.split(content["sizes"], np.cumsum(widths)[:-1])) if widths else ()
    parts = (content[name] for name in ("prediction", "columns", "bends"))
    base = Linearisation(runs, runs.origin, *parts)
    shape, factor, bent = (content[name] for name in ("shape", "factor", "bent"))
    return SignatureLibrary(base, runs.forward.hypotheses, owner, sizes, shape, factor, bent)
