"""ByMotion: a plant by its inverse dynamics, whose channels are efforts that a motion lacks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, filtfilt, savgol_filter

from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.model.directional import Moment, Visited
from ves_twin.diagnosis.model.forward import Channel, Excitation
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.model.invertible import Invertible
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.effects.law import Law, LawKind

WINDOW, DEGREE = 9, 4
"""Of the Savitzky-Golay filter that positions on the analysis grid go through: 0.09 s at 100 Hz."""

ORDER = 2
"""Of the low-pass at the plant's band, run forth and back: no phase."""

EDGE = 0.5
"""Periods of the band at either end of a recording that the filters do not know."""

QUIET = 0.01
"""Effort that counts as noise, as a share of what the plant as it is lacks."""

MOTION = "motion of "
"""Before the name of a channel whose smooth rows are fed in."""


@dataclass(frozen=True)
class ByMotion(ForwardWrapper):
    """A `Forward` whose channels are 0 where the plant is right, and minus what it lacks.

    Attributes:
        forward: the plant.
        noise: joint -> sd of its effort [N, N m].
        as_nominal: as efforts of the nominal plant's masses; see `Invertible`.
    """

    forward: Invertible
    noise: Mapping[str, float]
    as_nominal: bool = False

    @property
    def identity(self) -> str:
        """Of the plant, by its motion."""
        return self.identified(f"by motion {dict(self.noise)} {self.as_nominal}")

    @property
    def channels(self) -> tuple[Channel, ...]:
        """An effort of each joint."""
        unit = self.forward.effort_unit
        pairs = enumerate(self.noise.items())
        return tuple(Channel(missing_at(j), "", k, unit(j), sd) for k, (j, sd) in pairs)

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """See `LawForward`; there is no step that could be halved."""
        told = self.told(programme, values, laws)
        if told is None:
            return np.full((len(programme.time), len(self.noise)), np.nan)
        rows = -np.stack([told[0][joint] for joint in self.noise], axis=1)
        return self.in_band(rows, programme.period)

    def in_band(self, rows: FloatArray, period: float) -> FloatArray:
        """Rows (n, ...) at a period [s], as what is missing is seen: behind the plant's band."""
        share = 2.0 * self.forward.band * period
        if share >= 0.9:
            return rows
        return np.asarray(filtfilt(*butter(ORDER, share), rows, axis=0))

    def told(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]] | None:
        """What is missing, and variables of laws, as `Invertible` has them (n,)."""
        motion = {
            name.removeprefix(MOTION): rows[:, 0]
            for name, rows in programme.drive.items()
            if name.startswith(MOTION)
        }
        return self.forward.missing(programme, values, motion, self.as_nominal, laws)

    def law_places(self) -> tuple[LawPlace, ...]:
        """Joints of the plant at which an effort may act."""
        places = self.forward.law_places() if isinstance(self.forward, LawForward) else ()
        return tuple(p for p in places if p.kind is LawKind.EFFORT and p.name in self.noise)

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """See `LawForward`; as measured, whatever the laws."""
        told = self.told(programme, values, laws)
        return told[1] if told else {}

    def one_way_twins(
        self, labels: Sequence[str], moments: Sequence[Moment], visited: Visited | None = None
    ) -> Mapping[str, tuple[str, ...]]:
        """See `Directional`; of the motion as measured."""
        return super().one_way_twins(labels, moments, visited or self.visited)

    @property
    def band(self) -> float:
        """See `Invertible`."""
        return self.forward.band

    def effort_unit(self, joint: str) -> str:
        """See `Invertible`."""
        return self.forward.effort_unit(joint)

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> None:
        """None: its channels are efforts, and no motion."""


def missing_at(joint: str) -> str:
    """Name of the channel of what a joint lacks."""
    return f"{joint}.missing"


def by_motion(seen: Dataset, as_nominal: bool = False, noisy: bool = False) -> Dataset | None:
    """Recordings as efforts that their motion lacks: measured are zeros.

    Args:
        seen: recordings of an `Invertible`.
        as_nominal: as efforts of the nominal masses, to fit masses by.
        noisy: whether their noise is what the declared noise of the motion makes of them; else it
            is QUIET of what the plant lacks, by which the joints are weighed.

    Returns:
        None where the channels do not tell the motion, or there is next to none.
    """
    runs, plant = seen.runs, seen.runs.forward
    if not isinstance(plant, Invertible) or any(one.poses for one in runs.programmes):
        return None
    programmes = tuple(_moved(seen, k) for k in range(len(runs.programmes)))
    nominal = {p.name: p.nominal for p in plant.parameters}
    told = ByMotion(plant, {}, as_nominal).told(programmes[0], nominal)
    if told is None:
        return None
    unit = dict.fromkeys(told[0], 1.0)
    columns = tuple(range(len(unit)))
    first = Runs(ByMotion(plant, unit, as_nominal), programmes, columns, runs.workers)
    rows = first.one(first.origin)
    size = QUIET * np.sqrt(np.mean(np.square(rows, dtype=float), axis=0))
    if noisy:
        again = replace(
            first, programmes=tuple(_moved(_noisy(seen), k) for k in range(len(programmes)))
        )
        size = np.maximum(size, np.std(again.one(again.origin) - rows, axis=0, dtype=float))
    if not (np.isfinite(size).all() and np.all(size > 0.0)):
        return None
    noise = dict(zip(unit, size.tolist(), strict=True))
    holes = _holes(first, plant.band, np.asarray(runs.kept.all(axis=1)))
    found = replace(first, forward=ByMotion(plant, noise, as_nominal), holes=holes)
    return Dataset(found, np.zeros((first.slices[-1].stop, len(columns)), np.float32), ())


def _moved(seen: Dataset, recording: int) -> Excitation:
    """The programme of a recording with its channels, smooth, at its rows."""
    runs = seen.runs
    programme, at = runs.programmes[recording], runs.times[recording]
    rows = np.asarray(seen.measured[runs.slices[recording]], float)
    smooth = savgol_filter(rows, WINDOW, DEGREE, axis=0)
    curves = CubicSpline(at, smooth, axis=0)(np.clip(programme.time, at[0], at[-1]))
    names = [runs.forward.channels[c].name for c in runs.columns]
    motion = {MOTION + name: curve[:, None] for name, curve in zip(names, curves.T, strict=True)}
    return replace(programme, drive={**programme.drive, **motion})


def _noisy(seen: Dataset) -> Dataset:
    """The same recordings with the declared noise of each channel once more."""
    channels = [seen.runs.forward.channels[c] for c in seen.runs.columns]
    sd = np.array([channel.sd for channel in channels], np.float32)
    drawn = np.random.default_rng(0).standard_normal(seen.measured.shape)
    return replace(seen, measured=seen.measured + sd * drawn.astype(np.float32))


def _holes(runs: Runs, band: float, kept: BoolArray) -> tuple[BoolArray, ...]:
    """Rows of the grid of each recording (m, c) without a measurement, or too near its ends."""
    found = []
    for piece, grid in zip(runs.slices, runs.grids, strict=True):
        near = max(WINDOW, round(EDGE / (band * grid.step)))
        rows = ~kept[piece]
        rows[:near] = rows[-near:] = True
        found.append(np.repeat(rows[:, None], len(runs.columns), axis=1))
    return tuple(found)


def _by_motion(found: Dataset) -> ByMotion:
    forward = found.runs.forward
    if not isinstance(forward, ByMotion):
        raise TypeError(f"{type(forward).__name__} is not seen by its motion")
    return forward


def motions(found: Dataset, point: FloatArray) -> list[Mapping[str, FloatArray]]:
    """Variables of laws along each recording, by name (n,).

    Args:
        found: of `by_motion`.
        point: departures of the plant (coordinates,).
    """
    runs, forward = found.runs, _by_motion(found)
    told = [forward.told(one, runs.values(k, point)) for k, one in enumerate(runs.programmes)]
    return [one[1] if one else {} for one in told]


def along_motion(
    found: Dataset, point: FloatArray, effort: Callable[[Mapping[str, FloatArray]], FloatArray]
) -> FloatArray:
    """Efforts (rows, k) of variables (n,) along motions, as what is missing is seen.

    Args:
        found: of `by_motion`.
        point: departures of the plant (coordinates,).
        effort: (n, k) of the variables of laws, by name.
    """
    runs, forward = found.runs, _by_motion(found)
    triples = zip(runs.programmes, runs.grids, motions(found, point), strict=True)
    return np.concatenate(
        [
            grid.reduce(forward.in_band(effort(path), programme.period))
            for programme, grid, path in triples
        ]
    ).astype(float)
