"""answer_suite: diagnose every case of a blind suite from its recordings alone.

Nothing of the generator is imported here, and the key is not looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from ves_twin.core.errors import VesTwinError
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.machines.diagnose import diagnose as diagnose_machine
from ves_twin.machines.pendulum.excitations import pendulum_menu
from ves_twin.machines.pendulum.forward import Pendulum
from ves_twin.machines.pendulum.inputs import prepare_pendulum
from ves_twin.plant.plant import Plant
from ves_twin.suites.answers import Answer, read_answers, write_answers
from ves_twin.suites.material import Material, Use
from ves_twin.suites.suite import load_suite, next_file

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
    found = read_answers(answers) if answers.exists() else {}
    for n, case in enumerate(suite.cases):
        progress(n / len(suite.cases), case)
        played = not use.after or (folder / case / next_file(use.after)).is_file()
        if case not in found and played:
            begun = perf_counter()
            material = Material.of(folder, suite, case, use)
            try:
                excluded = suite.excluded.get(case, ())
                verdict = _verdict(suite.bench, material, excluded, settings)
                found[case] = Answer.of(verdict, perf_counter() - begun)
            except VesTwinError:
                found[case] = Answer("error", seconds=round(perf_counter() - begun, 1))
            write_answers(found, answers)
    return found


def _verdict(
    bench: str, material: Material, excluded: tuple[str, ...], settings: Settings
) -> Verdict:
    if bench == "pendulum":
        given = prepare_pendulum(
            Pendulum.with_command_delay(),
            material.recordings,
            material.held_out,
            material.commissioning,
            material.baseline,
        )
        recordings, held_out, commissioning, baseline = given.groups
        return diagnose(
            given.plant,
            recordings,
            held_out=held_out,
            standstill=material.standstill,
            commissioning=commissioning,
            baseline=baseline,
            next_programmes=pendulum_menu,
            exclude=excluded,
            settings=settings,
        )
    # no standstill: the legs hunt over a count there, and not in motion
    name = "ves2_pressure_fast" if bench == "ves2_fast" else "ves2_pressure"
    return diagnose_machine(
        material.recordings,
        Plant.load(name),
        held_out=material.held_out,
        commissioning=material.commissioning,
        baseline=material.baseline,
        exclude=excluded,
        settings=settings,
    ).verdict
