"""machine_of: the generator of a machine."""

from __future__ import annotations

from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.machine import BlindMachine
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.suite import OF_VES2, check_machine
from ves_twin.suites.ves2 import BlindVes2


def machine_of(name: str) -> BlindMachine:
    """The generator of a machine.

    Args:
        name: a name of `known_machines`, or the TOML file of an MJCF machine.

    Raises:
        UnknownNameError: no such machine.
        VesTwinError: a file that is missing or wrong.
    """
    check_machine(name)
    return BlindVes2(OF_VES2[name]) if name in OF_VES2 else BlindMjcf(Rig.load(name))
