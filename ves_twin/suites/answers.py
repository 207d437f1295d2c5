"""Answer: what was said of a case, as it stands in a file of answers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.whole_file import write_whole
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.suites.old_names import current_excitation, current_label, current_name

T = TypeVar("T")


@dataclass(frozen=True)
class Answer:
    """What was said of a case.

    Attributes:
        verdict: as in verdict.json, or "error".
        causes: effect@target of each, the most probable first.
        firm: whether each is called a fault for sure.
        probability: of the first.
        sizes: parameter -> (value, low, high, nominal), of all causes.
        gain: share of the excess on held-out data that the extension took; None without.
        seconds: that it took.
        energies: mean z^2 on held-out data before and after; None without.
        passed: whether the gate lets the extension through; None without held-out data.
        behind: effect@target of a single cause -> chi^2 that it leaves more than the best.
        programmes: offered next programme -> chi^2 by which it should part the causes.
        scale: of the tolerances, if recordings of other rigs told it.
        alternatives: numbers of the causes, from 0, that each of several explanations takes.
        acts_like: effect@target of a proved cause -> others, or several with "+" between, that do
            as well in its place.
    """

    verdict: str
    causes: Sequence[str] = ()
    firm: Sequence[bool] = ()
    probability: float = 0.0
    sizes: Mapping[str, Sequence[float]] | None = None
    gain: float | None = None
    seconds: float = 0.0
    energies: Sequence[float] | None = None
    passed: bool | None = None
    behind: Mapping[str, float] | None = None
    programmes: Mapping[str, float] | None = None
    scale: float | None = None
    alternatives: Sequence[Sequence[int]] = ()
    acts_like: Mapping[str, Sequence[str]] | None = None

    @property
    def current(self) -> Answer:
        """The same with the names of causes that the library has today."""
        return replace(
            self,
            causes=[current_label(label) for label in self.causes],
            sizes=_renamed(self.sizes, current_name),
            behind=_renamed(self.behind, current_label),
            programmes=_renamed(self.programmes, current_excitation),
        )

    @staticmethod
    def of(verdict: Verdict, seconds: float) -> Answer:
        """From a verdict."""
        gain = verdict.gain
        sizes = {
            f"{cause.effect}@{cause.target}:{name}": (p.value, p.low, p.high, p.nominal)
            for cause in verdict.causes
            for name, p in cause.parameters.items()
        }
        behind = {
            r.causes[0]: r.behind
            for r in verdict.rivals
            if len(r.causes) == 1 and r.behind is not None
        }
        return Answer(
            verdict.verdict.value,
            [f"{cause.effect}@{cause.target}" for cause in verdict.causes],
            [cause.firm for cause in verdict.causes],
            verdict.causes[0].probability if verdict.causes else 0.0,
            sizes,
            None if gain is None else gain.share,
            round(seconds, 1),
            None if gain is None else (gain.before, gain.after),
            None if gain is None else gain.passed,
            behind,
            {p.programme: p.separation for p in verdict.next_experiment},
            verdict.statistics.tolerance_scale,
            verdict.alternatives,
            {one.label: one.acts_like for one in verdict.proved if one.acts_like},
        )


def _renamed(given: Mapping[str, T] | None, name: Callable[[str], str]) -> dict[str, T] | None:
    return None if given is None else {name(key): value for key, value in given.items()}


def read_answers(path: Path) -> dict[str, Answer]:
    """Answers of a file; `ves-twin blind score` marks anybody's.

    Raises:
        FileAccessError: it cannot be read.
        InvalidInputError: not case -> {verdict, causes, ...}.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return {str(case): Answer(**answer).current for case, answer in content.items()}
    except OSError as error:
        raise FileAccessError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, TypeError, AttributeError):
        expected = 'answers: {"case-0001": {"verdict": "named", "causes": ["effect@target"]}}'
        raise InvalidInputError(str(path), "something else", expected) from None


def write_answers(found: Mapping[str, Answer], path: Path) -> None:
    """Write them whole or not at all.

    Raises:
        FileAccessError: not writable.
    """
    content = {case: vars(answer) for case, answer in sorted(found.items())}
    write_whole(path, json.dumps(content, indent=1) + "\n")
