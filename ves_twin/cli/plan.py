"""plan: what a recording could and could not find, before it is made."""

from __future__ import annotations

import argparse
import os
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
        "--scenario", metavar="NAME", default="identify_fast", help="what the rig would do"
    )
    parser.add_argument("--plant", metavar="FILE", help="the nominal plant (default: its own)")
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
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.compiled import cache_folder
    from ves_twin.diagnosis.plan import check_channels, plan_recording
    from ves_twin.diagnosis.settings import Settings
    from ves_twin.machines.ves2.diagnose_rig import drawn_nulls
    from ves_twin.machines.ves2.excitation import planned_rig
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.schema import Scenario

    scenario = Scenario.load(arguments.scenario)
    plant = Plant.load(arguments.plant or scenario.plant)
    seconds = arguments.seconds
    if seconds is not None and seconds > scenario.run.duration:
        scenario = Scenario.load(arguments.scenario, {"run.duration": seconds})
    settings = Settings(workers=os.cpu_count() or 1, cache=cache_folder().parent / "banks")
    settings = drawn_nulls(settings)
    with RunProgress("plan", 1.0, unit="share") as progress:
        progress.share(0.0, "set-points")
        forward, programme = planned_rig(scenario, plant)
        check_channels(forward, arguments.channels)
        return plan_recording(
            forward,
            programme,
            channels=arguments.channels,
            seconds=seconds,
            quick=arguments.quick,
            settings=settings,
            progress=progress.share,
        )
