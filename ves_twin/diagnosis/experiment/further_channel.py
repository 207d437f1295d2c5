"""further_channels: which further sensor would tell apart what a programme confuses."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.bank.slices import of_channels
from ves_twin.diagnosis.experiment.aliases import lookalikes
from ves_twin.diagnosis.experiment.design import score
from ves_twin.diagnosis.experiment.findable import findable_sizes
from ves_twin.diagnosis.experiment.separation import Question, parted, size_of
from ves_twin.diagnosis.fit.null import chance_floor
from ves_twin.diagnosis.model.forward import Excitation, Forward, check_forward
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings

SCHEMA = 1
"""Version of the table as JSON; fields are added without a new one."""


@dataclass(frozen=True)
class Gained:
    """What one more channel tells of the pairs that are confused without it.

    Attributes:
        channel: its name.
        unit: its unit.
        sd: of its noise, as declared or assumed.
        sigma: separation of all those pairs together, see `score`.
        told: pairs that are told apart from some size on and were at none before.
        left: pairs that still are confused at sizes that can be found.
    """

    channel: str
    unit: str
    sd: float
    sigma: float
    told: int
    left: int


@dataclass(frozen=True)
class Further:
    """Channels that could be added, those that tell most first.

    Attributes:
        programme: its name.
        recorded: channels that are recorded anyway.
        pairs: causes, two each, that these confuse.
        never: how many of the pairs are told apart at no size.
        sigma: separation of all pairs together, without any further channel.
        gained: of each further channel.
    """

    programme: str
    recorded: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...]
    never: int
    sigma: float
    gained: tuple[Gained, ...]
    schema: int = SCHEMA

    def to_json(self) -> str:
        """The table as JSON."""
        return json.dumps(asdict(self), indent=2, allow_nan=False)


def further_channels(
    forward: Forward,
    programme: Excitation,
    recorded: Sequence[int],
    *,
    settings: Settings,
    progress: Progress = silent,
) -> Further:
    """Rank the channels that are not recorded by what they tell of the pairs that are confused.

    By the signatures of one bank of all channels: of each channel they are a part.

    Args:
        forward: the plant with every channel that it could have.
        programme: what would be fed in.
        recorded: numbers of the channels that are recorded anyway.
        settings: how sure, where banks are kept.
        progress: told what is being done.

    Raises:
        InvalidInputError: no channel is left, or nothing is confused.
    """
    check_forward(forward)
    every = tuple(range(len(forward.channels)))
    others = [c for c in every if c not in set(recorded)]
    if not others:
        came = f"all {len(every)} channels of this machine"
        raise InvalidInputError("channels recorded already", came, "fewer: --channels names them")
    with Workers(settings.workers) as workers:
        runs = Runs(forward, (programme,), every, workers)

        def build() -> SignatureLibrary:
            return build_bank(runs, progress=progress, sparse=settings.sparse)

        bank = cached_bank(runs, settings.cache, build, settings.bank)
    now = _Seen.of(bank, recorded, settings)
    if not now.confused:
        names = ", ".join(forward.channels[c].name for c in recorded)
        raise InvalidInputError("causes that are confused", f"none by {names}", "two at least")
    causes = {h.label: h for h in bank.hypotheses}
    labels = sorted({tuple(sorted(pair)) for pair in now.confused})
    question = Question.of_pairs([(causes[a], causes[b]) for a, b in labels], "look-alikes")
    found = []
    for k, c in enumerate(others):
        progress(k / len(others), "further channels")
        seen, channel = _Seen.of(bank, [*recorded, c], settings), forward.channels[c]
        told = len(now.never) - len(now.never & seen.never)
        left = len({tuple(sorted(pair)) for pair in seen.confused if pair in now.confused})
        sigma = seen.sigma(question)
        found.append(Gained(channel.name, channel.unit, channel.sd, sigma, told, left))
    return Further(
        programme.name,
        tuple(forward.channels[c].name for c in recorded),
        tuple((a, b) for a, b in labels),
        len(now.never),
        now.sigma(question),
        tuple(sorted(found, key=lambda one: (-one.sigma, one.left))),
    )


@dataclass(frozen=True)
class _Seen:
    """What some channels tell.

    Attributes:
        screen: of them.
        confused: cause and other, up to some size or at any.
        never: of these, pairs that are told apart at no size.
    """

    screen: Screen
    confused: frozenset[tuple[str, str]]
    never: frozenset[frozenset[str]]

    @staticmethod
    def of(bank: SignatureLibrary, columns: Sequence[int], settings: Settings) -> _Seen:
        part = of_channels(bank, tuple(sorted(columns)))
        screen = Screen(part, whitening_declared(part.base.runs))
        sizes = findable_sizes(screen, chance_floor(len(bank.hypotheses), settings.alpha))
        pairs = lookalikes(screen, sizes, settings.odds, settings.model_error)
        return _Seen(
            screen,
            frozenset((p.cause, p.other) for p in pairs),
            frozenset(frozenset((p.cause, p.other)) for p in pairs if p.beyond is None),
        )

    def sigma(self, question: Question) -> float:
        """Separation of all pairs together, each cause at its `size_of`."""
        rows, factors = [], []
        for cause in question.causes:
            row, factor = self._entry(cause.label, float(np.linalg.norm(size_of(cause))))
            rows.append(row)
            factors.append(factor)
        gram = self.screen.gram[np.ix_(rows, rows)] * np.outer(factors, factors)
        return float(np.sqrt(score(question.least(parted(gram)))))

    def _entry(self, label: str, wanted: float) -> tuple[int, float]:
        """The entry of a cause nearest to a size, and what makes it that size."""
        bank = self.screen.bank
        labels = [h.label for h in bank.hypotheses]
        entries = bank.entries(labels.index(label))
        sizes: FloatArray = np.array([np.linalg.norm(bank.sizes[k]) for k in entries])
        nearest = int(np.argmin(np.abs(np.log(sizes / wanted))))
        return int(entries[nearest]), wanted / float(sizes[nearest])
