"""answer_suite: diagnose every case of a blind suite from its recordings alone.

Nothing of the generator is imported here, and the key is not looked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

from ves_twin.core.errors import VesTwinError
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.settings import Settings
from ves_twin.suites.answers import Answer, read_answers, write_answers
from ves_twin.suites.diagnosed import diagnosed, nominal_machine
from ves_twin.suites.material import Material, Use
from ves_twin.suites.suite import OF_VES2, Suite, load_suite, next_file

Progress = Callable[[float, str], None]

STAGE = "cases without an answer"


def answer_suite(
    folder: Path,
    answers: Path,
    settings: Settings,
    progress: Progress,
    use: Use | None = None,
) -> dict[str, Answer]:
    """Diagnose the cases that have no answer yet; each answer is kept at once.

    The first of them by all processes together, which fills the caches; then each process has a
    case of its own.

    Args:
        folder: of the suite.
        answers: JSON file: case -> answer.
        settings: of the diagnosis.
        progress: told how far it is.
        use: which recordings; all that there are, without a next experiment, if None. With one,
            the cases for which it was played.

    Raises:
        FileAccessError: no suite, or answers that cannot be written.
        InvalidInputError: a file that holds no answers.
    """
    suite, use = load_suite(folder), use or Use()
    found = read_answers(answers) if answers.exists() else {}
    played = [
        c for c in suite.cases if not use.after or (folder / c / next_file(use.after)).is_file()
    ]
    asked = [case for case in played if case not in found]
    if asked:
        progress(0.0, STAGE)
    for n, (case, answer) in enumerate(_Asked(folder, suite, settings, use).answers(asked), 1):
        found[case] = answer
        write_answers(found, answers)
        if n < len(asked):
            progress(n / len(asked), STAGE)
    return found


@dataclass(frozen=True)
class _Asked:
    """What each case of a suite is asked with."""

    folder: Path
    suite: Suite
    settings: Settings
    use: Use

    def answers(self, cases: Sequence[str]) -> Iterator[tuple[str, Answer]]:
        """Cases with their answers, as they come."""
        if cases:
            yield cases[0], self.answer(cases[0])
        alone = replace(self, settings=replace(self.settings, workers=1))
        with Workers(self.settings.workers) as workers:
            for n, answer in workers.as_done(alone.answer, cases[1:]):
                yield cases[1 + n], answer

    def answer(self, case: str) -> Answer:
        """What a diagnosis says of a case."""
        begun = perf_counter()
        machine = nominal_machine(self.suite.machine)
        material = Material.of(self.folder, self.suite, case, self.use)
        if self.suite.machine in OF_VES2:  # legs hunt over a count while they stand, not in motion
            material = replace(material, standstill=None)
        try:
            excluded = self.suite.excluded.get(case, ())
            said = diagnosed(machine, material, self.settings, excluded).verdict
        except VesTwinError:
            return Answer("error", seconds=round(perf_counter() - begun, 1))
        return Answer.of(said, perf_counter() - begun)
