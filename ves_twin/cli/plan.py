"""plan: what a recording could and could not find, before it is made."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.diagnosis.plan import Plan

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
    parser.add_argument("--json", action="store_true", help="the plan as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Plan and print."""
    from ves_twin.cli.plan_text import plan_text

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
