"""plan: what a recording could and could not find, before it is made."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.diagnosis.experiment.plan import Plan

SUMMARY = "what a recording could find and could not, before it is made"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--channels",
        metavar="NAME",
        nargs="+",
        default=[],
        help="signals or columns that would be recorded (default: all)",
    )
    parser.add_argument("--seconds", metavar="N", type=float, help="how long (default: all of it)")
    parser.add_argument(
        "--scenario",
        metavar="NAME",
        default="",
        help="what would be fed in: a scenario of VES II (default: identify_fast), an excitation"
        " that an MJCF machine offers, or a recording",
    )
    parser.add_argument(
        "--plant", metavar="FILE", help="the machine (default: the scenario's plant)"
    )
    parser.add_argument(
        "--quick", action="store_true", help="threshold of white noise; simulate no rigs in order"
    )
    parser.add_argument(
        "--design",
        metavar="A/B",
        help="optimise inputs that tell cause A from B, each a kind or kind@target; 'causes': all"
        " that the machine's first excitation confuses. Writes them and compares with the menu's"
        " best; --seconds is their length (default: 5)",
    )
    parser.add_argument(
        "--add-channel",
        action="store_true",
        help="rank further sensors by what they would tell of the causes that are confused now:"
        " those not in --channels, and those that an MJCF model could have",
    )
    parser.add_argument("--out", metavar="DIR", help="of --design (default: runs/design)")
    parser.add_argument("--json", action="store_true", help="the plan as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Plan and print."""
    from ves_twin.cli.plan_text import plan_text

    if arguments.add_channel:
        return _add_channel(arguments)
    if arguments.design is not None:
        return _design(arguments)
    if arguments.out is not None:
        from ves_twin.core.errors import InvalidInputError

        raise InvalidInputError("--out", arguments.out, "--design beside it: a plan is printed")

    plan = _plan(arguments)
    print(plan.to_json() if arguments.json else plan_text(plan))
    return 0


def _plan(arguments: argparse.Namespace) -> Plan:
    from ves_twin.cli.given import bank_settings
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.plan import plan

    with RunProgress("plan", 1.0, unit="share") as progress:
        return plan(
            arguments.plant,
            arguments.scenario,
            channels=arguments.channels,
            seconds=arguments.seconds,
            quick=arguments.quick,
            settings=bank_settings(),
            progress=progress.share,
        )


def _design(arguments: argparse.Namespace) -> int:
    from ves_twin.cli.design_text import design_text
    from ves_twin.cli.given import bank_settings
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.design import design

    with output_folder(arguments.out, "design") as held:
        with RunProgress("design", 1.0, unit="share") as progress:
            found = design(
                arguments.plant,
                arguments.design,
                arguments.scenario,
                channels=arguments.channels,
                seconds=arguments.seconds,
                settings=bank_settings(),
                progress=progress.share,
            )
        found.machine.save_excitation(found.design.excitation, held.path)
        written = sorted(path.name for path in held.path.glob("next_experiment.*"))
        where = f"written   {', '.join(written)} in {held.path}"
    print(found.design.to_json() if arguments.json else design_text(found.design))
    print(where, file=sys.stderr if arguments.json else sys.stdout)
    return 0


def _add_channel(arguments: argparse.Namespace) -> int:
    from ves_twin.cli.further_text import further_text
    from ves_twin.cli.given import bank_settings
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.machines.add_channel import add_channel

    for option in ("design", "seconds", "out"):
        given = getattr(arguments, option)
        if given is not None:
            raise InvalidInputError(f"--{option}", given, "--add-channel without it")
    with RunProgress("plan", 1.0, unit="share") as progress:
        found = add_channel(
            arguments.plant,
            arguments.scenario,
            channels=arguments.channels,
            settings=bank_settings(),
            progress=progress.share,
        )
    print(found.to_json() if arguments.json else further_text(found))
    return 0
