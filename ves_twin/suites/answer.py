"""answer_suite: diagnose every case of a blind suite from its recordings alone.

Nothing of the generator is imported here, and the key is not looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from ves_twin.core.errors import VesTwinError
from ves_twin.diagnosis.settings import Settings
from ves_twin.suites.answers import Answer, read_answers, write_answers
from ves_twin.suites.diagnosed import diagnosed, nominal_machine
from ves_twin.suites.material import Material, Use
from ves_twin.suites.suite import OF_VES2, load_suite, next_file

Progress = Callable[[float, str], None]


def answer_suite(
    folder: Path,
    answers: Path,
    settings: Settings,
    progress: Progress,
    use: Use | None = None,
) -> dict[str, Answer]:
    """Diagnose the cases that have no answer yet; each answer is kept at once.

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
    machine = nominal_machine(suite.machine)
    found = read_answers(answers) if answers.exists() else {}
    played = [
        c for c in suite.cases if not use.after or (folder / c / next_file(use.after)).is_file()
    ]
    asked = [case for case in played if case not in found]
    for n, case in enumerate(asked):
        progress(n / len(asked), "cases without an answer")
        begun = perf_counter()
        material = Material.of(folder, suite, case, use)
        if suite.machine in OF_VES2:  # legs hunt over a count while they stand, not in motion
            material = replace(material, standstill=None)
        try:
            excluded = suite.excluded.get(case, ())
            said = diagnosed(machine, material, settings, excluded).verdict
            found[case] = Answer.of(said, perf_counter() - begun)
        except VesTwinError:
            found[case] = Answer("error", seconds=round(perf_counter() - begun, 1))
        write_answers(found, answers)
    return found
