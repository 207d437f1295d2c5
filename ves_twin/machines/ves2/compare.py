"""compare: recordings against a plant, or against another recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.even_clock import FEWEST
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.residuals.channel import ChannelComparison, Column, compare_column
from ves_twin.diagnosis.residuals.coherence import Companions
from ves_twin.diagnosis.residuals.noise import Noise, NoiseSource, noise_of_difference
from ves_twin.machines.ves2.comparison_excitation import same_programme
from ves_twin.machines.ves2.comparison_result import Basis, Comparison, RecordingComparison, Traces
from ves_twin.machines.ves2.emulation_cost import EmulationCost, emulation_cost
from ves_twin.machines.ves2.prepared import POSE, Prepared, noise_of_columns, prepare
from ves_twin.machines.ves2.tolerance import Tolerance
from ves_twin.plant.plant import Plant
from ves_twin.scenario.experiment import Experiment
from ves_twin.simulator.simulate import versions

LEADERS = {
    "leg.length": "leg.command",
    "valve.command": "leg.command",
    "arm.q": "arm.command",
    "arm.torque": "arm.command",
}
"""Signal -> the command whose columns lead its own, one to one."""

Progress = Callable[[float, str], None]
"""Called with the share done and what is under way."""


@dataclass(frozen=True)
class Named:
    """A recording and its name."""

    name: str
    recording: Recording


def compare(
    recordings: Sequence[Named],
    plant: Plant | None = None,
    experiment: Experiment | None = None,
    tolerance: Tolerance | None = None,
    against: Named | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Where recordings part from a plant, or from another recording.

    Args:
        recordings: measured or simulated.
        plant: that is tried; if left out the experiment's, else the scenario's own.
        experiment: how they were made, as far as they do not say so themselves.
        tolerance: limits in SI.
        against: the recording that they are held against instead of the plant.
        progress: called before each simulation.

    Raises:
        VesTwinError: input that cannot be compared; says what and why.
    """
    if not recordings:
        raise InvalidInputError("recordings", "none", "at least one")
    told = experiment or Experiment()
    say = progress or (lambda share, what: None)
    told.check_names([n.name for n in (*recordings, *([against] if against else []))])
    prepared = [prepare(n.name, n.recording, told.of(n.name), plant) for n in recordings]
    other = None
    if against is not None:
        other = prepare(against.name, against.recording, told.of(against.name), plant)
    found = []
    for k, one in enumerate(prepared):
        say(k / len(prepared), one.name)
        own = told.of(one.name)
        found.append(_against(one, other, own, told) if other else _one(one, own))
    say(1.0, "done")
    excesses = None
    if tolerance is not None:
        excesses = tuple(e for r in found for e in tolerance.excesses(r.name, r.channels))
    return Comparison(tuple(found), excesses, versions())


def _one(one: Prepared, told: Experiment) -> RecordingComparison:
    noises = noise_of_columns(one, told.noise)
    return _compared(one, dict(one.recording.signals), one.simulated(), noises, Basis.PLANT)


def _against(
    one: Prepared, other: Prepared, told: Experiment, all_told: Experiment
) -> RecordingComparison:
    """Against another recording: directly, or each less the plant's answer to its set-points."""
    common = tuple(n for n in one.compared if n in other.compared)
    if not common:
        raise InvalidInputError("signals of --against", list(other.compared), str(one.compared))
    if abs(one.period / other.period - 1.0) > 1e-3:
        came = f"{1.0 / other.period:.4g} Hz"
        raise InvalidInputError("rate of --against", came, f"{1.0 / one.period:.4g} Hz")
    count = min(len(one.recording), len(other.recording))
    if count < one.rows.start + FEWEST:
        came = f"{count} rows, the comparison begins at row {one.rows.start}"
        raise InvalidInputError("length of --against", came, f"at least {FEWEST} rows in common")
    mine = noise_of_columns(one, told.noise)
    theirs = noise_of_columns(other, all_told.of(other.name).noise)
    noises = {
        column: noise_of_difference(noise, theirs[column])
        for column, noise in mine.items()
        if column in theirs
    }
    measured = {n: v[:count] for n, v in one.recording.signals.items()}
    before = {n: v[:count] for n, v in other.recording.signals.items() if n in (*common, POSE)}
    basis, difference = Basis.RECORDING, same_programme(one, other, count)
    if difference:
        basis = Basis.RESIDUAL
        ours, others = one.simulated(), other.simulated()
        before = {n: v + ours[n][:count] - others[n][:count] for n, v in before.items()}
    notes = one.notes
    if count < len(one.recording):
        notes += (f"{other.name} ends after {count} rows; so does the comparison",)
    if difference:
        notes += (
            f"another programme than {other.name}: {difference}. Each recording is taken less"
            " the plant's answer to its own set-points",
        )
    checks = one.checks + tuple(
        replace(check, message=f"{other.name}: {check.message}") for check in other.checks
    )
    rows = slice(one.rows.start, min(one.rows.stop, count))
    absent = one.absent + tuple(n for n in one.compared if n not in common)
    held = replace(one, compared=common, absent=absent, checks=checks, notes=notes, rows=rows)
    return _compared(held, measured, before, noises, basis)


def _compared(
    one: Prepared,
    measured: dict[str, FloatArray],
    expected: dict[str, FloatArray],
    noises: dict[str, Noise],
    basis: Basis,
) -> RecordingComparison:
    rows = one.rows
    time = one.recording.time[rows]
    measured = {n: v[rows] for n, v in measured.items()}
    expected = {n: v[rows] for n, v in expected.items()}
    channels, short = _channels(one, time, measured, expected, noises)
    return RecordingComparison(
        name=one.name,
        basis=basis,
        checks=one.checks,
        channels=channels,
        absent=(*one.absent, *short),
        cost=_cost(one, time, measured, expected),
        notes=(_noise_note(noises), *one.notes),
        start=one.offset + float(time[0]),
        stop=one.offset + float(time[-1]),
        rate=1.0 / one.period,
        plant=one.plant.name,
        plant_hash=one.plant.hash,
        made_by=one.recording.info.plant_hash,
        traces=Traces(one.offset + time, measured, expected),
    )


def _channels(
    one: Prepared,
    time: FloatArray,
    measured: dict[str, FloatArray],
    expected: dict[str, FloatArray],
    noises: dict[str, Noise],
) -> tuple[tuple[ChannelComparison, ...], tuple[str, ...]]:
    drive = {
        column: measured[name][:, i]
        for name in one.drive
        for i, column in enumerate(SIGNALS[name].columns)
    }
    companions = Companions(tuple(drive), np.column_stack(list(drive.values())))
    load = None
    if "sensor.wrench" in measured:
        load = np.linalg.norm(measured["sensor.wrench"][:, :3], axis=1)
    found, short = [], []
    for name in one.compared:
        signal = SIGNALS[name]
        for i, column in enumerate(signal.columns):
            leader = SIGNALS[LEADERS[name]].columns[i] if name in LEADERS else ""
            what = Column(
                name=column,
                signal=name,
                axis=signal.axes[i],
                unit=signal.units[i],
                noise=noises[column],
                leader=(leader, drive[leader]) if leader in drive else None,
            )
            result = compare_column(
                what, time, measured[name][:, i], expected[name][:, i], companions, drive, load
            )
            if result is None:
                short.append(column)
            else:
                found.append(result)
    return tuple(found), tuple(short)


def _cost(
    one: Prepared,
    time: FloatArray,
    measured: dict[str, FloatArray],
    expected: dict[str, FloatArray],
) -> EmulationCost | None:
    name = one.scenario.platform.emulated
    if name is None or "sensor.wrench" not in one.compared:
        return None
    pose = measured[POSE] - expected[POSE] if POSE in measured and POSE in expected else None
    attitude = measured.get("platform.command", measured.get(POSE, np.zeros((len(time), 6))))
    wrench = measured["sensor.wrench"] - expected["sensor.wrench"]
    known = np.where(np.isfinite(attitude), attitude, 0.0)[:, 3:]
    return emulation_cost(name, one.plant, time, wrench, known, pose)


def _noise_note(noises: dict[str, Noise]) -> str:
    words = {
        NoiseSource.STILL: "a part of this recording in which no set-point changes",
        NoiseSource.STANDSTILL: "the standstill recording given",
        NoiseSource.DECLARED: "the plant's numbers",
    }
    counts = {s: sum(n.source is s for n in noises.values()) for s in NoiseSource}
    parts = [
        f"{count} of {len(noises)} columns from {words[s]}" for s, count in counts.items() if count
    ]
    return f"noise: {'; '.join(parts)}"
