"""run_procedure: carry out a procedure (many runs, one result), write and print that."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.procedures.procedure import Procedure, Result


def run_procedure(arguments: argparse.Namespace) -> int | None:
    """Carry out what the arguments name; None where they name an ordinary scenario.

    Raises:
        VesTwinError: options that cannot be carried out, or a folder that cannot be written.
    """
    from ves_twin.cli.exit_codes import exit_code
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.core.whole_file import write_whole
    from ves_twin.plant.plant import Plant
    from ves_twin.procedures.procedure import RunContext
    from ves_twin.procedures.registry import load_procedure
    from ves_twin.scenario.load import parse_setting
    from ves_twin.simulator.simulate import SUMMARY_NAME

    changes = dict(parse_setting(text) for text in arguments.settings)
    procedure = load_procedure(arguments.scenario, changes)
    if procedure is None:
        return None
    if arguments.controller is not None:
        raise InvalidInputError("--controller", arguments.controller, "a scenario, not a procedure")
    if arguments.video is not None:
        raise InvalidInputError("--video", arguments.video, "a scenario, not a procedure")
    if arguments.seed is not None and not 0 <= arguments.seed < 2**63:
        raise InvalidInputError("--seed", arguments.seed, "at least 0 and below 2^63")
    plant = Plant.load(arguments.plant) if arguments.plant else None
    with output_folder(arguments.out, procedure.name) as held:
        folder = held.path
        with RunProgress(procedure.name, 1.0, unit="share") as progress:
            conduct = RunContext(folder, plant, arguments.seed, progress.share)
            result = procedure.carry_out(conduct)
        text = json_text(_summary(procedure, result))
        write_whole(folder / SUMMARY_NAME, text + "\n")
        files = ", ".join(sorted(p.name for p in folder.iterdir()))
    if arguments.json:
        print(text)
    else:
        head = f"{procedure.name}: {procedure.question}"
        outcome = f"  outcome   {result.outcome.value}"
        print("\n".join([head, outcome, "", *result.lines, "", f"  files     {folder}/: {files}"]))
    return exit_code(result.outcome)


def _summary(procedure: Procedure, result: Result) -> dict[str, object]:
    head = {
        "procedure": procedure.procedure,
        "name": procedure.name,
        "question": procedure.question,
        "outcome": result.outcome.value,
    }
    return {**head, **result.values, "options": procedure.model_dump(mode="json")}
