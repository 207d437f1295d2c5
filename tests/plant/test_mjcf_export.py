"""A plant as plain MJCF: MuJoCo alone makes the same rig of it, and it says what it lacks."""

from errno import ENOSPC

import mujoco
import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import FileAccessError
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.mjcf_export import mjcf_of

DIGITS = 2e-6
"""MJCF holds six to seven digits of lengths of up to a metre."""

EFFECTS = (
    vt.effects.CoulombFriction("leg.3", level=60.0),
    vt.effects.PayloadMass("arm.tool", mass=0.5),
    vt.effects.ValveNull("leg.2", null=0.01),
    vt.effects.BaseTilt("rig", roll=0.01, pitch=0.0),
)


@pytest.fixture(scope="module", params=["ves2", "ves2_pressure_fast"])
def plant(request):
    plant = vt.Plant.load(request.param).with_values({"leg.rod_mass": 2.8})
    return plant.extended(*EFFECTS)


def both(plant):
    """The rig as the package runs it, and as MuJoCo reads it from the file's text."""
    own = compile_model(assemble(plant, plant.parameters.number("clock.tick")))
    return own, mujoco.MjModel.from_xml_string(mjcf_of(plant).text)


def test_sizes_masses_inertias_and_joints_are_the_plants(plant):
    own, read = both(plant)
    for count in ("nq", "nv", "nu", "neq", "nbody", "njnt", "ntendon", "nsensor", "nsite"):
        assert getattr(own, count) == getattr(read, count), count
    assert read.body_mass == pytest.approx(own.body_mass, rel=1e-5)
    assert read.body_inertia == pytest.approx(own.body_inertia, rel=1e-5, abs=2e-9)
    for name in ("body_pos", "body_quat", "body_ipos", "site_pos", "qpos0", "jnt_pos", "jnt_axis"):
        assert getattr(read, name) == pytest.approx(getattr(own, name), abs=DIGITS), name
    for name in ("dof_armature", "dof_damping", "dof_frictionloss", "jnt_stiffness"):
        assert getattr(read, name) == pytest.approx(getattr(own, name), rel=1e-5), name
    assert read.tendon_frictionloss == pytest.approx(own.tendon_frictionloss, rel=1e-5)
    assert read.opt.gravity == pytest.approx(own.opt.gravity, abs=1e-5)
    assert read.opt.timestep == own.opt.timestep


def test_the_arm_falls_the_same_way_with_the_legs_driven_by_the_same_forces(plant):
    """0.4 s under gravity from home; 200 N on each leg bear part of the weight."""
    paths = []
    for model in both(plant):
        data = mujoco.MjData(model)
        data.ctrl[:6] = 200.0
        rows = []
        for _ in range(1170):
            mujoco.mj_step(model, data)
            rows.append(data.qpos.copy())
        paths.append(np.array(rows))
    own, read = paths
    assert np.ptp(own, axis=0).max() > 0.2  # it moves
    # lengths off by DIGITS; the fall multiplies that by about ten
    assert np.abs(own - read).max() < 20 * DIGITS


def test_the_file_says_what_it_carries_and_what_it_cannot(plant):
    export = mjcf_of(plant)
    assert set(export.carried) == {
        "coulomb_friction on leg.3",
        "payload_mass on arm.tool",
        "base_tilt on rig",
        "leg.rod_mass",
    }
    assert export.lost == ("valve_null on leg.2",)
    head = export.text[: export.text.index("-->")]
    assert "valve_null on leg.2" in head
    assert "plain motor" in head
    assert plant.hash in head


def test_an_unchanged_plant_loses_nothing_but_what_no_file_has():
    export = mjcf_of(vt.Plant.load("ves2"))
    assert (export.carried, export.lost) == ((), ())


def test_a_file_that_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(FileAccessError, match="cannot write"):
        mjcf_of(vt.Plant.load("ves2")).save(tmp_path / "no" / "rig.xml")


def test_info_writes_the_file_and_tells_the_differences_in_words(capsys, tmp_path):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        'schema = 1\nbase = "ves2"\n[parameters]\n"leg.rod_mass" = 2.8\n'
        '[effects.coulomb_friction."leg.3"]\nlevel = 60.0\n'
        '[effects.valve_null."leg.2"]\nnull = 0.01\n'
    )
    out = tmp_path / "rig.xml"
    assert main(["info", "--plant", str(rig), "--mjcf", str(out)]) == 0
    text = capsys.readouterr().out
    assert "level = 60 N. Dry friction: a joint or piston" in text
    assert "leg.dry_friction" in text[text.index("numbers that the effects change") :]
    lost = text[text.index("changes that it cannot carry") :]
    assert "valve_null on leg.2" in lost
    assert mujoco.MjModel.from_xml_path(str(out)).nq == 40


def test_mjcf_needs_a_plant(capsys):
    assert main(["info", "--mjcf", "rig.xml"]) == 2
    assert "--plant" in capsys.readouterr().err


def test_a_full_disk_leaves_what_was_there(tmp_path, monkeypatch):
    def fill(path, text, **options):
        path.write_bytes(text[:100].encode())
        raise OSError(ENOSPC, "No space left on device")

    path = tmp_path / "rig.xml"
    path.write_text("before")
    monkeypatch.setattr("pathlib.Path.write_text", fill)
    with pytest.raises(FileAccessError, match="No space left"):
        mjcf_of(vt.Plant.load("ves2")).save(path)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
