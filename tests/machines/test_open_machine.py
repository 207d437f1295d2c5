"""A machine by its name: the nearest of all that ship, VES II's plants and MJCF machines alike."""

import pytest

from ves_twin.core.errors import UnknownNameError
from ves_twin.machines.load import open_machine, shipped_machines, shipped_plants


@pytest.mark.parametrize(("came", "near"), [("empz", "emps"), ("pendulun", "pendulum")])
def test_a_misspelt_mjcf_machine_gets_the_nearest_name(came, near):
    with pytest.raises(UnknownNameError, match=f"did you mean '{near}'"):
        open_machine(came)


def test_a_misspelt_plant_of_ves_2_does_too():
    with pytest.raises(UnknownNameError, match="did you mean 'ves2_fast'"):
        open_machine("ves2_fats")


def test_every_name_opens():
    for name in (*shipped_plants(), *shipped_machines()):
        assert open_machine(name).name
