"""of_recording, of_channels, of_time: a bank for a part of what it was built for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.types import IntArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.record.runs import Runs


def of_recording(bank: SignatureLibrary, number: int) -> SignatureLibrary:
    """The bank of one recording alone; what is drawn anew for the others is gone.

    Args:
        bank: at nominal.
        number: of the recording, from 0.
    """
    runs = bank.base.runs
    holes = runs.holes[number : number + 1]
    part = replace(runs, programmes=(runs.programmes[number],), holes=holes)
    axes = [runs.coordinates[int(i)].recording for i in runs.nuisances]
    kept = [n for n, recording in enumerate(axes) if recording in (-1, number)]
    rows = np.arange(runs.slices[number].start, runs.slices[number].stop)
    return _part(bank, part, [*kept, len(axes)], rows)


def of_channels(bank: SignatureLibrary, columns: Sequence[int]) -> SignatureLibrary:
    """The bank of some of the channels.

    Args:
        bank: at nominal, without holes.
        columns: numbers of channels of the forward, some of those the bank has.
    """
    runs = bank.base.runs
    part = replace(runs, columns=tuple(columns))
    here = [runs.columns.index(c) for c in columns]
    base = replace(
        bank.base,
        runs=part,
        prediction=bank.base.prediction[..., here],
        columns=bank.base.columns[..., here],
    )
    return replace(bank, base=base, bent=bank.bent[..., here])


def of_time(bank: SignatureLibrary, seconds: float) -> SignatureLibrary:
    """The bank of the first seconds of its one programme: what comes later changes nothing before.

    Args:
        bank: at nominal, of one recording.
        seconds: from the programme's first row.
    """
    runs = bank.base.runs
    fed = runs.programmes[0]
    count = int(np.searchsorted(fed.time, fed.time[0] + seconds + 0.5 * fed.period))
    drive = {name: values[:count] for name, values in fed.drive.items()}
    part = replace(runs, programmes=(replace(fed, time=fed.time[:count], drive=drive),))
    every = range(len(bank.base.columns))
    return _part(bank, part, list(every), np.arange(len(part.times[0])))


def _part(
    bank: SignatureLibrary, runs: Runs, columns: list[int], rows: IntArray
) -> SignatureLibrary:
    base = Linearisation(
        runs,
        runs.origin,
        bank.base.prediction[rows],
        bank.base.columns[columns][:, rows],
        bank.base.bends[columns],
    )
    # a shape is a column of the base, or one of those behind them
    count = len(bank.base.columns)
    place = np.concatenate([np.full(count, -1), np.arange(len(bank.bent)) + len(columns)])
    place[columns] = np.arange(len(columns))
    return replace(bank, base=base, shape=place[bank.shape], bent=bank.bent[:, rows])
