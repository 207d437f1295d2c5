"""plan_recording: what a programme could and could not find, before anything is recorded."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.bank.slices import of_channels, of_time
from ves_twin.diagnosis.experiment.aliases import Lookalike, lookalikes
from ves_twin.diagnosis.experiment.findable import findable_sizes
from ves_twin.diagnosis.fit.null import cached_thresholds, noise_floor
from ves_twin.diagnosis.fit.tolerances import naming_limit
from ves_twin.diagnosis.model.forward import Excitation, Forward, check_forward
from ves_twin.diagnosis.record.preprocess import FEWEST_ROWS
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings

SCHEMA = 1
"""Version of the plan as JSON; fields are added without a new one."""


@dataclass(frozen=True)
class Prospect:
    """What a recording could say about one cause.

    Attributes:
        effect, target: the cause.
        unit: of the sizes.
        smallest: size that is found seven times of ten; None if no size in its range is.
        sd: declared commissioning sd; 0 if the effect is absent by declaration.
        firm: size from which it is called a fault rather than a commissioning error.
    """

    effect: str
    target: str
    unit: str
    smallest: float | None
    sd: float
    firm: float | None


@dataclass(frozen=True)
class Plan:
    """What a programme could find.

    Attributes:
        programme: its name.
        seconds: how much of it.
        channels: columns that would be recorded.
        threshold: chi^2 that a cause must take away, what bends of commissioning errors included.
        null: "simulated" rigs in order gave it, or "white noise" alone, which is the least it is.
        naming_limit: declared sd beyond which a departure is a fault.
        prospects: every cause.
        lookalikes: causes that would be taken for one another.
    """

    programme: str
    seconds: float
    channels: tuple[str, ...]
    threshold: float
    null: str
    naming_limit: float
    prospects: tuple[Prospect, ...]
    lookalikes: tuple[Lookalike, ...]
    schema: int = SCHEMA

    def to_json(self) -> str:
        """The plan as JSON."""
        return json.dumps(asdict(self), indent=2, allow_nan=False)


def plan_recording(
    forward: Forward,
    programme: Excitation,
    *,
    channels: Sequence[str] = (),
    seconds: float | None = None,
    quick: bool = False,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Plan:
    """What recordings of a programme could tell, with noise and tolerances as declared.

    The bank is that of the whole programme and of all channels, so that it serves a later
    diagnosis too; a shorter time or fewer channels are a part of it.

    Args:
        forward: the plant and its library.
        programme: what would be fed in.
        channels: signals or columns that would be recorded; all if none are given.
        seconds: of the programme that would be recorded; all if left out.
        quick: take the threshold of white noise, without simulating rigs in order.
        settings: how sure, where banks are kept.
        progress: told what is being done.

    Raises:
        UnknownNameError: a channel that the plant does not have.
        InvalidInputError: a time that is too short, or longer than the programme.
    """
    chosen = settings or Settings()
    check_forward(forward)
    with Workers(chosen.workers) as workers:
        runs = Runs(forward, (programme,), tuple(range(len(forward.channels))), workers)
        return _plan(runs, channels, seconds, quick, chosen, progress)


def _plan(
    runs: Runs,
    channels: Sequence[str],
    seconds: float | None,
    quick: bool,
    chosen: Settings,
    progress: Progress,
) -> Plan:
    forward, programme = runs.forward, runs.programmes[0]
    columns, length = columns_of(forward, channels), _length(runs, seconds)

    def build() -> SignatureLibrary:
        return build_bank(runs, progress=progress, sparse=chosen.sparse)

    whole = cached_bank(runs, chosen.cache, build, chosen.bank)
    part = whole if length is None else of_time(whole, length)
    bank = of_channels(part, columns)
    whitening = whitening_declared(bank.base.runs)
    screen = Screen(bank, whitening)
    floor = noise_floor(bank, chosen.alpha)
    threshold = floor
    if not quick:
        limits = cached_thresholds(bank, whitening, chosen, progress)
        # as a diagnosis allows what commissioning errors explain, here what they may be expected to
        bent = limits.bends**2 * float(np.sum(screen.metric.columns**2))
        threshold = limits.effect + bent
    sizes = findable_sizes(screen, threshold)
    limit = naming_limit(bank, None)
    fed = bank.base.runs.programmes[0]
    return Plan(
        programme=programme.name,
        seconds=float(fed.time[-1] - fed.time[0]),
        channels=tuple(forward.channels[c].name for c in columns),
        threshold=threshold,
        null="white noise" if quick else "simulated",
        naming_limit=limit,
        prospects=_prospects(screen, sizes, limit),
        lookalikes=tuple(lookalikes(screen, sizes, chosen.odds, chosen.model_error)),
    )


def check_channels(forward: Forward, names: Sequence[str]) -> None:
    """Raise UnknownNameError for a name that is neither a signal nor a column of the plant."""
    known = {c.name for c in forward.channels} | {c.signal for c in forward.channels}
    for name in names:
        if name not in known:
            raise UnknownNameError("channel", name, known)


def columns_of(forward: Forward, names: Sequence[str]) -> tuple[int, ...]:
    """Numbers of the channels of some signals or columns; all if none are given.

    Raises:
        UnknownNameError: a name that is neither.
    """
    check_channels(forward, names)
    return tuple(
        c
        for c, channel in enumerate(forward.channels)
        if not names or channel.name in names or channel.signal in names
    )


def _length(runs: Runs, seconds: float | None) -> float | None:
    if seconds is None:
        return None
    time = runs.programmes[0].time
    least, most = FEWEST_ROWS * runs.grids[0].step * 1.2, float(time[-1] - time[0])
    if not least <= seconds <= most * 1.01:
        raise InvalidInputError("seconds", seconds, f"{least:.3g} to {most:.4g}")
    return min(seconds, most)


def _prospects(
    screen: Screen, sizes: dict[str, float | None], limit: float
) -> tuple[Prospect, ...]:
    runs = screen.bank.base.runs
    found = []
    for hypothesis in screen.bank.hypotheses:
        parameter = runs.coordinates[int(runs.indices(hypothesis)[0])].parameter
        smallest = sizes.get(hypothesis.label)
        firm = None if smallest is None else max(smallest, limit * parameter.sd)
        found.append(
            Prospect(
                hypothesis.effect,
                hypothesis.target,
                parameter.unit,
                smallest,
                parameter.sd,
                firm,
            )
        )
    return tuple(found)
