"""prepare_inputs: recordings of VES II made fit for a diagnosis, or refused with what is wrong."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ves_twin.core.errors import InvalidInputError, VesTwinError
from ves_twin.core.recording.even_clock import even_clock
from ves_twin.core.recording.recording import Recording
from ves_twin.data.quality.check import Check, Grade
from ves_twin.data.quality.gate import quality_gate
from ves_twin.machines.ves2.declared_load import LOAD
from ves_twin.machines.ves2.forward import DRIVE
from ves_twin.machines.ves2.leg_program_check import check_leg_program
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.replay import replay_scenario

REFUSED = frozenset({"wiring", "sign", "units", "frame"})
"""Checks whose failure makes any cause that is named a wrong one: the recording is not what it says
it is."""

SORTS = {
    "measured": "recording",
    "held_out": "held-out recording",
    "commissioning": "commissioning recording",
    "baseline": "baseline recording",
}
"""What recordings are for -> what they are called in messages."""


@dataclass(frozen=True)
class Inputs:
    """Recordings on even clocks, and the checks that they failed without being refused."""

    recordings: tuple[Recording, ...]
    flaws: tuple[Check, ...]


def prepare_inputs(
    recordings: Sequence[Recording],
    plant: Plant,
    word: str,
    scenario: Scenario | None = None,
    misread: bool = False,
) -> Inputs:
    """Put recordings through the quality gate and on an even clock.

    Rows that are missing become rows without measurements, and short holes of the set-points are
    bridged; `even_clock` says how.

    Args:
        recordings: measured or simulated.
        plant: whose arm the force sensor carries.
        word: what they are called in messages, for instance "recording".
        scenario: how the leg program was set; as each recording says if None.
        misread: whether lengths may be other ones in the log than the leg program read; the flaws
            then tell which.

    Raises:
        VesTwinError: columns that look swapped, turned, in other units or in another frame, or
            lengths that the leg program did not read.
        UnknownNameError: a set-point that is not recorded.
        InvalidInputError: set-points that are missing for too long.
    """
    carried, gravity = plant.parameters.array("arm.mass").sum(), plant.parameters.number("gravity")
    full_speed = plant.parameters.number("hydraulics.full_speed")
    even, flaws = [], []
    for number, recording in enumerate(recordings, 1):
        name = f"{word} {number}"
        load = recording[LOAD.name][0, 0] if LOAD.name in recording.signals else 0.0
        failed = quality_gate(recording, float((carried + load) * gravity)).failures
        wrong = [check for check in failed if check.name in REFUSED]
        known = scenario is not None or json.loads(recording.info.settings)
        if known and not wrong:  # else it would say the same in other words
            legs = replay_scenario(recording, scenario).legs
            program = check_leg_program(recording, legs, full_speed)
            off = [program] if program.grade is Grade.FAILED else []
            failed, wrong = ((*failed, *off), []) if misread else (failed, off)
        if wrong:
            raise VesTwinError(f"{name}: {'; '.join(check.message for check in wrong)}")
        flaws += [replace(check, message=f"{name}: {check.message}") for check in failed]
        for signal in DRIVE:
            recording[signal]  # told by name where it is missing
        fed = (*DRIVE, LOAD.name) if LOAD.name in recording.signals else DRIVE
        even.append(even_clock(recording, fed))
    return Inputs(tuple(even), tuple(flaws))


def one_step(scenario: Scenario) -> Scenario:
    """A scenario with the model's own step, whatever a recording was made with."""
    return scenario.model_copy(update={"run": scenario.run.model_copy(update={"substeps": 1})})


def check_settings(recordings: Sequence[Recording], first: Scenario) -> None:
    """Raise InvalidInputError where a recording was made with other rates or leg settings."""
    for number, recording in enumerate(recordings, 1):
        other = replay_scenario(recording)
        for what, here, there in (
            ("platform.rate", other.platform.rate, first.platform.rate),
            ("legs", other.legs, first.legs),
        ):
            if here != there:
                where = f"recording {number}: {what}"
                raise InvalidInputError(where, here, f"{there}, as in the first one")
