"""answer_suite: diagnose every case of a blind suite from its recordings alone.

Nothing of the generator is imported here, and the key is not looked for.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from ves_twin.benches.diagnose_rig import diagnose_rig
from ves_twin.benches.pendulum import Pendulum
from ves_twin.blind.suite import HELD_OUT, RECORDING, STANDSTILL, load_suite
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.errors import FileAccessError, InvalidInputError, VesTwinError
from ves_twin.plant.plant import Plant
from ves_twin.recording.files import load_recording

Progress = Callable[[float, str], None]


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
    """

    verdict: str
    causes: Sequence[str] = ()
    firm: Sequence[bool] = ()
    probability: float = 0.0
    sizes: Mapping[str, Sequence[float]] | None = None
    gain: float | None = None
    seconds: float = 0.0

    @staticmethod
    def of(verdict: Verdict, seconds: float) -> Answer:
        """From a verdict."""
        sizes = {
            f"{cause.effect}@{cause.target}:{name}": (p.value, p.low, p.high, p.nominal)
            for cause in verdict.causes
            for name, p in cause.parameters.items()
        }
        return Answer(
            verdict.verdict.value,
            [f"{cause.effect}@{cause.target}" for cause in verdict.causes],
            [cause.firm for cause in verdict.causes],
            verdict.causes[0].probability if verdict.causes else 0.0,
            sizes,
            None if verdict.gain is None else verdict.gain.share,
            round(seconds, 1),
        )


def answer_suite(
    folder: Path, answers: Path, settings: Settings, progress: Progress
) -> dict[str, Answer]:
    """Diagnose the cases that have no answer yet; each answer is kept at once.

    Args:
        folder: of the suite.
        answers: JSON file: case -> answer.
        settings: of the diagnosis.
        progress: told how far it is.

    Raises:
        FileAccessError: no suite, or answers that cannot be written.
        InvalidInputError: a file that holds no answers.
    """
    suite = load_suite(folder)
    found = read_answers(answers) if answers.exists() else {}
    for n, case in enumerate(suite.cases):
        progress(n / len(suite.cases), case)
        if case not in found:
            excluded = suite.excluded.get(case, ())
            found[case] = _answer(suite.bench, folder, case, excluded, settings)
            _write(found, answers)
    return found


def read_answers(path: Path) -> dict[str, Answer]:
    """Answers of a file; `ves-twin blind score` marks anybody's.

    Raises:
        FileAccessError: it cannot be read.
        InvalidInputError: not case -> {verdict, causes, ...}.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return {str(case): Answer(**answer) for case, answer in content.items()}
    except OSError as error:
        raise FileAccessError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, TypeError, AttributeError):
        expected = 'answers: {"case-0001": {"verdict": "named", "causes": ["effect@target"]}}'
        raise InvalidInputError(str(path), "something else", expected) from None


def _answer(
    bench: str, folder: Path, case: str, excluded: tuple[str, ...], settings: Settings
) -> Answer:
    begun = perf_counter()
    record = load_recording(folder / case / RECORDING)
    held_out = [load_recording(folder / case / HELD_OUT)]
    still = load_recording(folder / STANDSTILL)
    try:
        if bench == "pendulum":
            verdict = diagnose(
                Pendulum.with_command_delay(),
                [record],
                held_out=held_out,
                standstill=still,
                exclude=excluded,
                settings=settings,
            )
        else:  # no standstill: the legs hunt over a count there, and not in motion
            name = "ves2_pressure_fast" if bench == "ves2_fast" else "ves2_pressure"
            verdict = diagnose_rig(
                [record],
                Plant.load(name),
                held_out=held_out,
                exclude=excluded,
                settings=settings,
            ).verdict

    except VesTwinError:
        return Answer("error", seconds=round(perf_counter() - begun, 1))
    return Answer.of(verdict, perf_counter() - begun)


def _write(found: Mapping[str, Answer], path: Path) -> None:
    content = {case: vars(answer) for case, answer in found.items()}
    part = path.with_suffix(".part")
    try:
        part.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from None
