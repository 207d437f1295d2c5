"""diagnosed: the verdict on the recordings of one case, and the machine that it makes."""

from __future__ import annotations

from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import Diagnosis, diagnose
from ves_twin.machines.load import open_machine
from ves_twin.machines.machine import Machine
from ves_twin.suites.material import Material
from ves_twin.suites.suite import OF_VES2


def nominal_machine(name: str) -> Machine:
    """The machine of a suite as a diagnosis has it.

    Raises:
        VesTwinError: a machine that is missing or wrong.
    """
    return open_machine(OF_VES2.get(name, name))


def diagnosed(
    machine: Machine,
    material: Material,
    settings: Settings,
    exclude: tuple[str, ...] = (),
    progress: Progress = silent,
) -> Diagnosis:
    """Diagnose recordings of a machine.

    Raises:
        VesTwinError: recordings that cannot be diagnosed.
    """
    return diagnose(
        material.recordings,
        machine,
        held_out=material.held_out,
        commissioning=material.commissioning,
        standstill=material.standstill,
        baseline=material.baseline,
        exclude=exclude,
        settings=settings,
        progress=progress,
    )
