"""offered_programmes: what VES II could do next, within its stroke, speed and wrench limits."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ves_twin.core.errors import EndedEarlyError, FileAccessError, UnreachableError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.forward import DRIVE
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import simulate

SECONDS = 10.0
"""Length of an offered programme: long enough for the slow tilts to begin and end."""

SPEED_SHARE = 0.9
"""Share of a rod's full speed that set-points may ask for."""

MENU: Mapping[str, tuple[str, Mapping[str, object]]] = {
    "quick motion of legs and arm (identify_fast)": ("identify_fast", {}),
    "slow tilts and arm poses (identify_slow)": ("identify_slow", {}),
    "quick motion of the legs, arm standing": ("identify_fast", {"arm.moves": []}),
    "slow tilts, arm standing": ("identify_slow", {"arm.moves": []}),
    "quick small motion of the legs up to 5 Hz": (
        "identify_fast",
        {
            "platform.motion.amplitude": [0.02, 0.02, 0.02, "1.5 deg", "1.5 deg", "2 deg"],
            "platform.motion.band": [0.1, 5.0],
        },
    ),
    "arm motion, platform standing": (
        "identify_fast",
        {"platform.motion.amplitude": [1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6]},
    ),
}
"""Name -> scenario, and what is changed of it."""


def offered_programmes(plant: Plant, scenario: Scenario) -> tuple[Excitation, ...]:
    """Set-points of every entry of the menu that the plant carries out within its limits.

    A run that is completed keeps the stroke with its margin and the sensor's range, which the
    simulator checks in every tick; the speed of the set-points is checked here.

    Args:
        plant: the nominal rig.
        scenario: of the recording: its rates and leg settings are kept.
    """
    found = []
    for name, (base, changes) in MENU.items():
        run = carried_out(plant, scenario, base, {**changes, "run.duration": SECONDS})
        if run is not None:
            found.append(Excitation.of(run, DRIVE, name))
    return tuple(found)


def carried_out(
    plant: Plant, scenario: Scenario, base: str, changes: Mapping[str, object]
) -> Recording | None:
    """The run of a programme; None where a limit of stroke, rod speed or sensor ends it.

    Args:
        plant: the nominal rig.
        scenario: its rates and leg settings are kept.
        base: scenario that is run.
        changes: of it.
    """
    given = Scenario.load(base, changes)
    rate = given.platform.model_copy(update={"rate": scenario.platform.rate})
    planned = given.model_copy(update={"platform": rate, "legs": scenario.legs})
    try:
        recording = simulate(planned, plant=plant)
    except (EndedEarlyError, UnreachableError):
        return None
    if recording.info.outcome != Outcome.COMPLETED:
        return None
    fastest = SPEED_SHARE * float(np.min(plant.parameters.array("hydraulics.full_speed")))
    speed = np.diff(recording["leg.command"], axis=0) / np.diff(recording.time)[:, None]
    return recording if np.abs(speed).max() < fastest else None


def write_setpoints(programme: Excitation, path: Path) -> None:
    """Write a programme as CSV: t [s], leg.command.1 ... [m], arm.command.1 ... [rad].

    Raises:
        FileAccessError: the file cannot be written.
    """
    names = ("leg.command", "arm.command")
    columns = [column for name in names for column in SIGNALS[name].columns]
    rows = np.column_stack([programme.time, *(programme.drive[name] for name in names)])
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["t", *columns])
            writer.writerows([f"{value:.12g}" for value in row] for row in rows)
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from None
