"""planned_rig: the set-points that a scenario gives VES II, and the rig that gets them."""

from __future__ import annotations

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.ves2.diagnose_rig import one_step
from ves_twin.machines.ves2.filter_place import WithFilterPlaces
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.replay import replay_scenario
from ves_twin.simulator.simulate import simulate


def planned_rig(scenario: Scenario, plant: Plant) -> tuple[WithFilterPlaces, Excitation]:
    """The forward of a rig and the programme of a scenario, as a diagnosis of its recording has.

    Under position control the set-points are those of every rig; where a controller makes them of
    what it measures, they are those of this plant.

    Args:
        scenario: what would be run.
        plant: the nominal rig.

    Raises:
        InvalidInputError: a scenario that this rig does not carry out to its end.
    """
    recording = simulate(scenario, plant=plant)
    if recording.info.outcome != Outcome.COMPLETED:
        what = f"scenario {scenario.name}"
        raise InvalidInputError(what, recording.info.outcome, "a run that is completed")
    forward = WithFilterPlaces(RigForward(plant, one_step(replay_scenario(recording))))
    return forward, Excitation.of(recording, DRIVE, scenario.name)
