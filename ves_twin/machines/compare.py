"""compare: recordings against a machine, or against another recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.even_clock import FEWEST
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.channel import ChannelComparison, Column, compare_column
from ves_twin.diagnosis.record.residuals.coherence import Companions
from ves_twin.diagnosis.record.residuals.noise import Noise, NoiseSource, noise_of_difference
from ves_twin.machines.case import Case
from ves_twin.machines.comparison import Basis, Comparison, RecordingComparison, Traces
from ves_twin.machines.load import Given, machine_of, named
from ves_twin.machines.machine import Machine, Named
from ves_twin.machines.reach import tolerance_reach
from ves_twin.machines.same_programme import same_programme
from ves_twin.machines.tolerance import Excess, Tolerance
from ves_twin.scenario.experiment_file import ExperimentFile
from ves_twin.simulator.simulate import versions

Progress = Callable[[float, str], None]
"""Called with the share done and what is under way."""

PATIENCE = 30.0
"""Time [s] that the tolerance envelope of a recording may take unless one is asked for."""

Rows = dict[str, FloatArray]
"""Signal -> rows (n, width)."""


def compare(
    recordings: Sequence[Recording | Named],
    plant: Given = None,
    experiment: ExperimentFile | None = None,
    tolerance: Tolerance | None = None,
    against: Recording | Named | None = None,
    standstill: Recording | None = None,
    progress: Progress | None = None,
    patience: float = PATIENCE,
) -> Comparison:
    """Where recordings part from a machine, or from another recording.

    Args:
        recordings: measured or simulated.
        plant: the machine, or its name or file; of VES II, if left out, the experiment's plant,
            else the one that a recording's own scenario names.
        experiment: how they were made, as far as they do not say so themselves.
        tolerance: limits in SI.
        against: the recording that they are held against instead of the machine.
        standstill: tells the noise in place of what the experiment says.
        progress: called before each simulation.
        patience: time [s] that the tolerance envelope of a recording may take; where it would take
            longer, a note says so instead.

    Raises:
        VesTwinError: input that cannot be compared; says what and why.
    """
    if not recordings:
        raise InvalidInputError("recordings", "none", "at least one")
    say = progress or (lambda share, what: None)
    machine, given = machine_of(plant), named(recordings, "recording")
    other: tuple[Named, ...] = ()
    if against is not None:
        other = (against if isinstance(against, Named) else Named("the other recording", against),)
    if experiment is not None:
        experiment.check_names([n.name for n in (*given, *other)])

    def cases(one: Named) -> list[Case]:
        made = machine.cases(one, experiment)
        return [c if standstill is None else replace(c, standstill=standstill) for c in made]

    prepared = [cases(one) for one in given]
    others = {case.mode: case for one in other for case in cases(one)}
    found: list[RecordingComparison] = []
    excesses: list[Excess] = []
    for k, modes in enumerate(prepared):
        say(k / len(prepared), given[k].name)
        if against is None:
            own = [_one(case) for case in modes]
            own = _enveloped(own, machine, given[k], experiment, patience, say)
        else:
            own = [_against(case, others[case.mode]) for case in modes if case.mode in others]
        if tolerance is not None:
            excesses += tolerance.excesses(given[k].name, [c for r in own for c in r.channels])
        found += own
    say(1.0, "done")
    kept = None if tolerance is None else tuple(excesses)
    return Comparison(tuple(found), kept, versions())


def _one(one: Case) -> RecordingComparison:
    noises = one.noise()
    return _compared(one, dict(one.recording.signals), dict(one.simulated()), noises, Basis.PLANT)


def _enveloped(
    found: list[RecordingComparison],
    machine: Machine,
    given: Named,
    experiment: ExperimentFile | None,
    patience: float,
    say: Progress,
) -> list[RecordingComparison]:
    """The first mode, that of a diagnosis, with the band in which a machine in order may lie."""
    first, *rest = found
    reach = tolerance_reach(machine, given, experiment, patience, say)
    if isinstance(reach, str):
        return [replace(first, notes=(*first.notes, reach)), *rest]
    bands = {n: np.interp(first.traces.time, reach.time, sd) for n, sd in reach.sd.items()}
    return [replace(first, traces=replace(first.traces, reach=bands)), *rest]


def _against(one: Case, other: Case) -> RecordingComparison:
    """Against another recording: directly, or each less the machine's answer to its set-points."""
    common = tuple(n for n in one.outputs if n in other.outputs)
    if not common:
        raise InvalidInputError("signals of --against", list(other.outputs), str(one.outputs))
    if abs(one.period / other.period - 1.0) > 1e-3:
        came = f"{1.0 / other.period:.4g} Hz"
        raise InvalidInputError("rate of --against", came, f"{1.0 / one.period:.4g} Hz")
    count = min(len(one.recording), len(other.recording))
    if count < one.rows.start + FEWEST:
        came = f"{count} rows, the comparison begins at row {one.rows.start}"
        raise InvalidInputError("length of --against", came, f"at least {FEWEST} rows in common")
    mine, theirs = one.noise(), other.noise()
    noises = {
        column: noise_of_difference(noise, theirs[column])
        for column, noise in mine.items()
        if column in theirs
    }
    measured = {n: v[:count] for n, v in one.recording.signals.items()}
    kept = (*common, *one.beside)
    before = {n: v[:count] for n, v in other.recording.signals.items() if n in kept}
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
    absent = one.absent + tuple(n for n in one.outputs if n not in common)
    held = replace(one, outputs=common, absent=absent, checks=checks, notes=notes, rows=rows)
    return _compared(held, measured, before, noises, basis)


def _compared(
    one: Case, measured: Rows, expected: Rows, noises: dict[str, Noise], basis: Basis
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
        cost=one.cost(time, measured, expected),
        notes=(_noise_note(noises), *one.notes),
        start=one.offset + float(time[0]),
        stop=one.offset + float(time[-1]),
        rate=1.0 / one.period,
        plant=one.machine,
        plant_hash=one.identity,
        made_by=one.recording.info.plant_hash,
        mode=one.mode,
        slow_below=0.5 * one.rate,
        poses=one.poses,
        traces=Traces(one.offset + time, measured, expected),
        imposed=one.imposed,
    )


def _channels(
    one: Case, time: FloatArray, measured: Rows, expected: Rows, noises: dict[str, Noise]
) -> tuple[tuple[ChannelComparison, ...], tuple[str, ...]]:
    inputs = {
        column: measured[name][:, i]
        for name in one.inputs
        for i, column in enumerate(one.signals[name].columns)
    }
    drive = np.array(list(inputs.values()), float).reshape(len(inputs), len(time)).T
    companions = Companions(tuple(inputs), drive)
    load, rate = one.load(measured), None if one.poses else one.rate
    found, short = [], []
    for name in one.outputs:
        signal = one.signals[name]
        for i, column in enumerate(signal.columns):
            leader = one.signals[one.leaders[name]].columns[i] if name in one.leaders else ""
            what = Column(
                name=column,
                signal=name,
                index=i,
                axis=signal.axes[i],
                unit=signal.units[i],
                noise=noises[column],
                rate=rate,
                leader=(leader, inputs[leader]) if leader in inputs else None,
            )
            result = compare_column(
                what, time, measured[name][:, i], expected[name][:, i], companions, load
            )
            if result is None:
                short.append(column)
            else:
                found.append(result)
    return tuple(found), tuple(short)


def _noise_note(noises: dict[str, Noise]) -> str:
    words = {
        NoiseSource.STILL: "a part of this recording in which no set-point changes",
        NoiseSource.STANDSTILL: "the standstill recording given",
        NoiseSource.DECLARED: "the machine's numbers",
        NoiseSource.NOBODY: "nobody, so that nothing is said of noise",
    }
    counts = {s: sum(n.source is s for n in noises.values()) for s in NoiseSource}
    parts = [
        f"{count} of {len(noises)} columns from {words[s]}" for s, count in counts.items() if count
    ]
    return f"noise: {'; '.join(parts)}"
