"""write_next_experiment: a proposed programme as set-points, and as a scenario that plays them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.core.toml_file import write_toml
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.machine import SCENARIO, SETPOINTS
from ves_twin.machines.ves2.excitations import write_setpoints
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.setpoint_motion import poses_of


def write_next_experiment(
    programme: Excitation, scenario: Scenario, plant: Plant, folder: Path
) -> None:
    """Write SETPOINTS for the laboratory's own programs, and SCENARIO for `ves-twin run`.

    The recording of that run, or the laboratory's of the same set-points, is what the next
    diagnosis takes.

    Args:
        programme: set-points of legs and arm.
        scenario: of the diagnosis: rates, leg gains, belief.
        plant: the nominal rig; a run takes the shipped one of its form unless told otherwise.
        folder: takes both files.

    Raises:
        FileAccessError: not writable.
    """
    write_setpoints(programme, folder / SETPOINTS)
    note = f"Which of the causes that look alike is it? Programme: {programme.name}"
    write_toml(folder / SCENARIO, _content(programme, scenario, plant), note)


def _content(programme: Excitation, scenario: Scenario, plant: Plant) -> dict[str, object]:
    first = np.ascontiguousarray(programme.drive["leg.command"][:1])
    start = poses_of(first, np.zeros(6), belief_of(scenario).geometry)[0]
    # round-off of the inverse kinematics, which would show as a start beside home
    start = np.where(np.abs(start) < 1e-9, 0.0, start)
    legs, gravity = scenario.legs, scenario.gravity
    return {
        "plant": plant.base,
        "belief": scenario.belief,
        "run": {"duration": float(programme.time[-1] + 0.5 * programme.period)},
        "platform": {
            "mode": "position",
            "rate": scenario.platform.rate,
            "start": start.tolist(),
            "motion": {"kind": "setpoints", "file": SETPOINTS},
        },
        "gravity": {"zero": gravity.zero}
        | ({"method": "model", "file": gravity.file} if gravity.file else {}),
        "legs": legs.model_dump(mode="json"),
        "arm": {"start": programme.drive["arm.command"][0].tolist()},
    }
