"""Truth: what was hidden in one case."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import StrEnum

from ves_twin.suites.model_error import Family, ModelError
from ves_twin.suites.old_names import current_label, current_size


class Hidden(StrEnum):
    """What a case hides.

    outside: a kind that the library lacks, or one of the library that the diagnosis must exclude.
    confusable: one of a group that a programme hardly tells apart.
    edited: a cause of the library that no class of effect made. many: six to twelve causes of the
    library at once, and one or two outside it.
    """

    NONE = "none"
    SINGLE = "single"
    PAIR = "pair"
    OUTSIDE = "outside"
    CONFUSABLE = "confusable"
    EDITED = "edited"
    MANY = "many"


@dataclass(frozen=True)
class HiddenCause:
    """One effect of the library at a size.

    Attributes:
        effect, target: as the library names it.
        departures: parameter -> departure from nominal.
        d: size in sigma of the noise that commissioning errors cannot take away.
        share: its rms, of that of the column where it is largest.
        likes: other causes that have its columns.
    """

    effect: str
    target: str
    departures: Mapping[str, float]
    d: float
    share: float = 0.0
    likes: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """effect@target."""
        return f"{self.effect}@{self.target}"

    @staticmethod
    def of(
        effect: str,
        target: str,
        departures: Mapping[str, float],
        d: float,
        share: float = 0.0,
        likes: Sequence[str] = (),
    ) -> HiddenCause:
        """From a file, whose names may be older."""
        effect, _, target = current_label(f"{effect}@{target}").partition("@")
        return HiddenCause(effect, target, _current(departures), d, share, tuple(likes))


@dataclass(frozen=True)
class Truth:
    """What was hidden, and how well it can be seen.

    Attributes:
        case: name of the case.
        hidden: which sort.
        causes: effects of the library.
        outside: kind outside the library, or the edit that makes the cause; empty if none.
        outside_size: in the kind's unit.
        spread: commissioning errors, in declared sd.
        values: of every parameter that was drawn or hidden; empty until it is recorded.
        background: kinds outside the library that the rig has besides, with their sizes.
        aliases: causes, alone or together, that would leave hardly anything of a cause which
            the diagnosis must leave out.
        repaired: whether nothing is hidden any more in the held-out recording.
        errors: what its model gets wrong in single columns.
    """

    case: str
    hidden: Hidden
    causes: tuple[HiddenCause, ...] = ()
    outside: str = ""
    outside_size: float = 0.0
    spread: float = 1.0
    values: Mapping[str, float] = field(default_factory=dict)
    background: Mapping[str, float] = field(default_factory=dict)
    aliases: tuple[tuple[str, ...], ...] = ()
    repaired: bool = False
    errors: tuple[ModelError, ...] = ()

    @property
    def labels(self) -> frozenset[str]:
        """effect@target of each cause."""
        return frozenset(cause.label for cause in self.causes)

    @property
    def family(self) -> Family | None:
        """Of its causes outside the library, where it hides many; the last errors are those."""
        return self.errors[-1].family if self.hidden is Hidden.MANY and self.errors else None

    @property
    def d(self) -> float:
        """The smallest of its causes' sizes in sigma; 0 without one."""
        return min((cause.d for cause in self.causes), default=0.0)

    def to_json(self) -> str:
        """As text, to be sealed."""
        return json.dumps(asdict(self))

    @staticmethod
    def from_json(text: str) -> Truth:
        """From text, also of earlier suites."""
        content = json.loads(text)
        causes = tuple(HiddenCause.of(**cause) for cause in content.pop("causes"))
        groups = content.pop("aliases" if "aliases" in content else "stand_ins", ())
        aliases = tuple(tuple(map(current_label, labels)) for labels in groups)
        content["values"] = _current(content.get("values", {}))
        sort = Hidden(content.pop("hidden"))
        errors = tuple(ModelError.of(one) for one in content.pop("errors", ()))
        return Truth(causes=causes, hidden=sort, aliases=aliases, errors=errors, **content)


def _current(sizes: Mapping[str, float]) -> dict[str, float]:
    return dict(current_size(name, value) for name, value in sizes.items())
