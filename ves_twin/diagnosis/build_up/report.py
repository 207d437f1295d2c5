"""report_of: what a proof comes to, in names, channels and units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray, SingleArray
from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.in_its_place import Replaced
from ves_twin.diagnosis.build_up.inseparable import inseparable
from ves_twin.diagnosis.build_up.leftover_laws import Law, by_channel, laws_left, same_motion
from ves_twin.diagnosis.build_up.memory import memory
from ves_twin.diagnosis.build_up.one_way import with_one_way_twins
from ves_twin.diagnosis.build_up.proof import FALSE_SHARE, Proof
from ves_twin.diagnosis.build_up.regression import Half, Regression
from ves_twin.diagnosis.build_up.rests_on import rests_on
from ves_twin.diagnosis.build_up.result import TOGETHER, Beyond, BuildUp, Left, Proved, Size
from ves_twin.diagnosis.build_up.spanned import spanned_by
from ves_twin.diagnosis.build_up.stand_ins import StandIns

ALONG = 0.3
"""Correlation from which channels are said to go along with what another one leaves."""

STEADY = 0.7
"""Rms about the mean, as a share of all of it, below which what a cause adds is mostly steady: half
of its power. A load on a cylinder is known by the mean, whatever the force does about it."""

LOUD = 3.0
"""Times the noise of a row from which what is left of a channel is no noise alone."""

SPOILT = 1.25
"""Times the rms error without it from which a cause is said to spoil a channel where it acts, which
a mechanism does not. Chosen between a tool of an arm that is there (1.20 in a wrist) and a heavier
wheel that is not (1.46), among 153 firm names of twenty measured machines."""

SHAKEN = 0.25
"""Share of a cause's amplitude from which a law of the same motion in what is left shakes its
name. Chosen on EMPS, whose three frictions are published and leave a law of a tenth of theirs."""


def report_of(
    halves: Halves,
    proof: Proof,
    ends: tuple[FloatArray, FloatArray],
    points: tuple[FloatArray, FloatArray] | None = None,
    replaced: Replaced | None = None,
) -> BuildUp:
    """Everything that is told of a proof, sizes excepted.

    Args:
        halves: both halves.
        proof: what is proved.
        ends: what the extended model leaves of the fitted and of the held-out half (rows, c).
        points: its departures in the fitted and in the held-out half (coordinates,); none if None.
        replaced: full fits with others in the place of those that columns tell alone; none if None.
    """
    regression = halves.regression
    fit = regression.solve(proof.proved, proof.bench.fit.whitening)
    bench = replace(proof.bench, fit=fit)
    left = ends[1]
    laws = laws_left(bench, *ends)
    found, trials = StandIns.of(proof), regression.trials
    others = {**found.within}
    together = inseparable(proof, others)  # of columns, which those of full fits do not have
    if replaced is not None:
        others |= replaced.others([n for n in proof.proved if trials[n].bent and not others[n]])
    shared = {name for one in together for name in one.names}
    lost = _unfollowed(bench.held, halves.measured, left)
    proved = [
        replace(
            _proved(bench, proof, n, others[n], laws, left, lost),
            beyond=tuple(_beyond(regression, k, size) for k, size in found.beyond[n].items()),
        )
        for n in proof.proved
    ]
    proved.sort(key=lambda one: (-one.share, one.p))
    told = (replace(p, firm=p.firm and p.label not in shared and not p.beyond) for p in proved)
    return BuildUp(
        proved=with_one_way_twins(tuple(told), halves, points),
        tested=proof.tested,
        false_discovery_rate=FALSE_SHARE,
        p_limit=proof.limit,
        unproved={trials[n].cause.label: p for n, p in proof.dropped.items()},
        left=_left(bench, left, laws),
        inseparable=together,
    )


def _beyond(regression: Regression, trial: int, sizes: FloatArray) -> Beyond:
    runs, cause = regression.half.runs, regression.trials[trial].cause
    found = {}
    for i, size in zip(runs.indices(cause), sizes.tolist(), strict=True):
        one = runs.coordinates[int(i)].parameter
        name, value = one.name.rpartition(":")[2], one.nominal + size
        found[name] = Size(value, one.low, one.high, one.unit, one.nominal)
    return Beyond(cause.label, found)


def _unfollowed(half: Half, measured: SingleArray, left: FloatArray) -> BoolArray:
    """Channels (c,) of whose swings about their mean more than noise, and than they, is left.

    A simulation that is out of step is worse than none: what stiffens or brakes it improves the
    prediction, whatever is wrong (a satellite's mass centre, 20 times too far off).
    Efforts that a motion lacks are measured as zeros: there is nothing to follow.
    """
    runs = half.runs
    noise = np.array([runs.forward.channels[c].sd for c in runs.columns])
    rms = half.rms(_swings(half, left))
    moves = half.rms(_swings(half, measured))
    return np.asarray((moves > 0.0) & (rms > moves) & (rms > LOUD * noise))


def _swings(half: Half, rows: FloatArray | SingleArray) -> FloatArray:
    """Rows (rows, c) of each recording about their mean."""
    found: FloatArray = np.nan_to_num(np.array(rows, float))
    for part in half.runs.slices:
        count = np.maximum(half.kept[part].sum(axis=0), 1)
        found[part] -= np.sum(found[part], axis=0, where=half.kept[part]) / count
    return found


def _proved(
    bench: Bench,
    proof: Proof,
    trial: int,
    others: Sequence[int],
    laws: list[Law],
    left: FloatArray,
    lost: BoolArray,
) -> Proved:
    trials, half = bench.regression.trials, bench.held
    rest = bench.residual([n for n in proof.proved if n != trial])
    change = rest - bench.residual(proof.proved)
    without = left + change
    before, after = half.rms(without), half.rms(left)
    names = _names(half)
    acts = np.flatnonzero(bench.acts(trial))
    own = max(acts, key=lambda c: before[c] - after[c])
    motion = same_motion(bench.regression.half, trial, int(own))
    taken = SHAKEN**2 * float(before[own] ** 2 - after[own] ** 2)
    ruled = any(
        law.channel == own and law.variable in motion and law.share * after[own] ** 2 > taken
        for law in laws
    )
    cause, difference = trials[trial].cause, proof.differences[trial]
    like = [trials[n].cause.label for n in others]
    if not like:
        like = [TOGETHER.join(trials[n].cause.label for n in spanned_by(proof, trial))]
    swings = half.rms(_swings(half, change)) > STEADY * half.rms(change)
    unfollowed = tuple(names[c] for c in acts if lost[c] and swings[c])
    spoils = tuple(names[c] for c in acts if after[c] > (1.0 if c == own else SPOILT) * before[c])
    firm = not any(like) and not ruled and not unfollowed and not spoils
    return Proved(
        effect=cause.effect,
        target=cause.target,
        parameters={},
        p=difference.p,
        blocks=difference.blocks,
        takes={names[c]: (float(before[c]), float(after[c])) for c in acts},
        firm=firm,
        acts_like=tuple(dict.fromkeys(filter(None, like))),
        unfollowed=unfollowed,
        spoils=spoils,
        rests_on=rests_on(proof, trial) if firm else (),
    )


def _left(bench: Bench, left: FloatArray, laws: list[Law]) -> dict[str, Left]:
    half, names = bench.held, _names(bench.held)
    rms, first = half.rms(left), half.rms(half.target)
    grid = half.runs.grids[0]
    rows = half.kept.all(axis=1)
    spread = left[rows] if np.count_nonzero(rows) > 2 else left
    with np.errstate(invalid="ignore", divide="ignore"):  # nothing goes along with a still column
        along = np.atleast_2d(np.corrcoef(spread.T))
    found = {}
    for c, name in enumerate(names):
        channel = half.runs.forward.channels[half.runs.columns[c]]
        noise = float(np.sqrt(grid.autocovariance(channel.sd, 0, channel.corner)[0]))
        found[name] = Left(
            rms=float(rms[c]),
            before=float(first[c]),
            unit=channel.unit,
            noise=noise,
            memory=memory(spread[:, c]) * grid.step,
            along={
                names[k]: float(along[c, k])
                for k in range(len(names))
                if k != c and abs(along[c, k]) > ALONG
            },
            laws=by_channel(laws, c),
        )
    return found


def _names(half: Half) -> list[str]:
    runs = half.runs
    return [runs.forward.channels[c].name for c in runs.columns]
