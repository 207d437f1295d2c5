"""run_procedure: carry out a procedure (many runs, one result), write and print its account."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.procedures.procedure import Account, Procedure


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
    from ves_twin.simulator.simulate import SUMMARY_NAME, make_folder

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
    folder = output_folder(arguments.out, procedure.name)
    make_folder(folder)
    with RunProgress(procedure.name, 1.0, unit="share") as progress:
        conduct = RunContext(folder, plant, arguments.seed, progress.share)
        account = procedure.carry_out(conduct)
    text = json_text(_summary(procedure, account))
    write_whole(folder / SUMMARY_NAME, text + "\n")
    if arguments.json:
        print(text)
    else:
        files = ", ".join(sorted(p.name for p in folder.iterdir()))
        head = f"{procedure.name}: {procedure.question}"
        outcome = f"  outcome   {account.outcome.value}"
        print("\n".join([head, outcome, "", *account.lines, "", f"  files     {folder}/: {files}"]))
    return exit_code(account.outcome)


def _summary(procedure: Procedure, account: Account) -> dict[str, object]:
    head = {
        "procedure": procedure.procedure,
        "name": procedure.name,
        "question": procedure.question,
        "outcome": account.outcome.value,
    }
    return {**head, **account.values, "options": procedure.model_dump(mode="json")}
