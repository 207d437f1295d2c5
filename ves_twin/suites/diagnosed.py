"""diagnosed: the verdict on the recordings of one case, and the machine that it makes."""

from __future__ import annotations

from typing import Any

from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.mjcf.diagnose_mjcf import MjcfDiagnosis, diagnose_mjcf
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.ves2.diagnose_rig import RigDiagnosis, diagnose_rig
from ves_twin.plant.plant import Plant
from ves_twin.suites.material import Material
from ves_twin.suites.suite import OF_VES2

Diagnosed = MjcfDiagnosis | RigDiagnosis


def nominal_machine(name: str) -> Rig | Plant:
    """The machine of a suite as a diagnosis has it.

    Raises:
        VesTwinError: a machine that is missing or wrong.
    """
    return Plant.load(OF_VES2[name]) if name in OF_VES2 else Rig.load(name)


def diagnosed(
    machine: Rig | Plant,
    material: Material,
    settings: Settings,
    exclude: tuple[str, ...] = (),
    progress: Progress = silent,
) -> Diagnosed:
    """Diagnose recordings of a machine.

    The standstill of VES II tells nothing: legs hunt over a count there, and not in motion.

    Raises:
        VesTwinError: recordings that cannot be diagnosed.
    """
    given: dict[str, Any] = {
        "held_out": material.held_out,
        "commissioning": material.commissioning,
        "baseline": material.baseline,
        "exclude": exclude,
        "settings": settings,
        "progress": progress,
    }
    if isinstance(machine, Plant):
        return diagnose_rig(material.recordings, machine, **given)
    return diagnose_mjcf(material.recordings, machine, standstill=material.standstill, **given)
