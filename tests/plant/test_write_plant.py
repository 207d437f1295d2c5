"""A written plant loads again as the same physics."""

import pytest

import ves_twin as vt
from ves_twin.core.errors import FileAccessError
from ves_twin.plant.write_plant import write_plant


@pytest.mark.parametrize("base", ["ves2", "ves2_pressure", "ves2_pressure_fast"])
def test_a_written_plant_is_the_same_physics(tmp_path, base):
    plant = (
        vt.Plant.load(base)
        .with_values({"leg.rod_mass": 2.7, "hydraulics.valve_null": [0, 0, 0.01, 0, 0, 0]})
        .extended(
            vt.effects.CoulombFriction("leg.3", level=60.0),
            vt.effects.BaseTilt("rig", roll=1e-3, pitch=-2e-3),
            vt.effects.SensorCrossTalk("sensor.mx.fz", share=0.003),
        )
    )
    path = tmp_path / "found.toml"
    write_plant(plant, path, "what was found\non two lines")
    assert vt.Plant.load(str(path)).hash == plant.hash
    assert path.read_text().startswith("# what was found\n# on two lines\n")
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(FileAccessError, match="cannot write"):
        write_plant(vt.Plant.load("ves2"), tmp_path / "no" / "plant.toml")


def test_a_plant_of_any_name_loads_again(tmp_path):
    path = tmp_path / 'rig \U0001f600 "a".toml'
    plant = vt.Plant.load("ves2")
    write_plant(plant, path)
    assert vt.Plant.load(str(path)).hash == plant.hash
