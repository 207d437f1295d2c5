"""An MJCF machine as one MJCF file: MuJoCo finds in it what the machine's file had found."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
import servo_rig
import two_link

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.effects.joints import ForceOffset
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.actuator_bias import bias_of
from ves_twin.machines.mjcf.rig.description import Mode, Setting
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.mjcf_export import mjcf_of

RIGS = {one.__name__: one for one in (two_link, servo_rig)}
KINDS = [(name, kind) for name, one in RIGS.items() for kind in one.TARGETS]

ON_SIGNALS = {
    "sensor_gain", "cross_talk", "sensor_offset", "sensor_wander", "sensor_delay", "clock_rate"
}  # fmt: skip
ON_COMMANDS = {
    "actuator_delay", "actuator_offset", "actuator_deadband", "actuator_asymmetry",
    "actuator_saturation", "drive_cross_talk",
}  # fmt: skip
BY_LAW = {
    "viscous_asymmetry", "coulomb_asymmetry", "load_friction", "quadratic_drag",
    "stribeck_friction", "regularized_friction", "friction_behind_gap", "one_way_load",
    "dahl_friction", "ripple", "backlash",
}  # fmt: skip
LOST = ON_SIGNALS | ON_COMMANDS | BY_LAW

DIGITS = 1e-4
"""MJCF holds six digits of a number; motions of some seconds make ten times that of it, as a share
of how far an effect moves a channel."""


def changed(rig, kind):
    """A rig with one effect of a kind at a fifth of its range, and that effect's sizes."""
    entry = next(e for e in rig.entries if e.effect.kind == kind)
    bounds = {p.name: p for p in rig.parameters}
    sizes = {
        m.name: n + 0.2 * (bounds[entry.name(m)].high - n)
        for m, n in zip(entry.magnitudes, entry.nominal, strict=True)
    }
    told = rig.description
    if entry.effect.attribute:
        name, attribute = entry.effect.setting
        on = {"attribute": attribute, str(entry.effect.element): name}
        new = Setting.model_validate(on | {"value": next(iter(sizes.values()))})
        others = [one for one in told.parameters if one.element != new.element]
        update = {"parameters": (*others, new)}
    else:
        update = {"present": {kind: {entry.effect.target: sizes}}}
    return replace(rig, description=told.model_copy(update=update))


@pytest.mark.parametrize(("name", "kind"), KINDS, ids=[kind for _, kind in KINDS])
def test_the_exported_model_moves_as_the_machine_with_its_effect_does(name, kind, tmp_path):
    """Where MJCF has no place for an effect the file moves as the machine without it, and says so."""
    nominal = RIGS[name].rig(tmp_path)
    with_effect = changed(nominal, kind)
    export = mjcf_of(with_effect, tmp_path)
    (tmp_path / "exported.xml").write_text(export.text)
    plain = {"model": "exported.xml", "parameters": ()}
    told = nominal.description.model_copy(update=plain)
    read = Rig(told, tmp_path)
    fed = RIGS[name].programme()
    here, there, before = (
        MjcfForward.of(one, Mode.CONTROL).simulate(fed, {}) for one in (with_effect, read, nominal)
    )
    like, other = (before, here) if kind in LOST else (here, before)
    scale = np.max(np.abs(like), axis=0) + 1e-9
    assert np.max(np.abs(there - like) / scale) < DIGITS
    own = mjcf_of(nominal, tmp_path)
    assert own.lost == ()
    assert bool(export.lost) is (kind in LOST)
    assert (export.carried == own.carried) is (kind in LOST)
    assert kind in ON_SIGNALS or np.max(np.abs(other - like) / scale) > 10 * DIGITS
    assert all(one in export.text[: export.text.index("-->")] for one in export.lost)


def test_meshes_are_found_from_where_the_file_lies(tmp_path):
    parts = tmp_path / "model" / "parts"
    parts.mkdir(parents=True)
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    text = (
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    (parts / "block.obj").write_text(text)
    (tmp_path / "model" / "arm.xml").write_text(
        '<mujoco><compiler meshdir="parts"/><asset><mesh name="block" file="block.obj"/></asset>'
        '<worldbody><body><joint name="swing" damping="0.1"/><geom type="mesh" mesh="block"/></body>'
        '</worldbody><actuator><motor name="drive" joint="swing"/></actuator></mujoco>'
    )
    machine = tmp_path / "model" / "arm.toml"
    machine.write_text(
        'schema = 1\nkind = "rig"\nname = "arm"\nmodel = "arm.xml"\nclock = { column = "t" }\n'
        'signals = { torque = { columns = ["u"], unit = "N*m" }, '
        'angle = { columns = ["a"], unit = "rad", noise = 1e-3 } }\n'
        'drive = { mode = "control", actuators = { drive = "torque" } }\n'
        'compare = { angle = { joint = "swing" } }\n'
        "typical = { joint = { swing = { effort = 1.0, speed = 1.0, travel = 1.0 } } }\n"
        '[[parameters]]\njoint = "swing"\nattribute = "damping"\nvalue = 0.3\n'
    )
    out = tmp_path / "answers" / "new" / "arm.xml"
    out.parent.mkdir(parents=True)
    assert main(["info", "--plant", str(machine), "--mjcf", str(out)]) == 0
    read = mujoco.MjModel.from_xml_path(str(out))
    assert read.nmesh == 1
    assert read.dof_damping[0] == pytest.approx(0.3)
    assert str(tmp_path) not in out.read_text()


def test_info_tells_a_machine_and_writes_it(tmp_path, capsys):
    two_link.write_files(
        tmp_path,
        more='\n[[parameters]]\njoint = "rail"\nattribute = "damping"\nvalue = 5.5\n'
        "\n[present.actuator_delay.drive]\ndelay = 0.008\n",
    )
    (machine,) = tmp_path.glob("*.toml")
    out = tmp_path / "out.xml"
    assert main(["info", "--plant", str(machine), "--mjcf", str(out)]) == 0
    text = capsys.readouterr().out
    (line,) = [one for one in text.splitlines() if "damping of joint rail" in one][:1]
    assert "4 -> 5.5 N*s/m" in line
    lost = text[text.index("cannot carry") :]
    assert "actuator_delay on drive" in lost
    assert "Changes that were found together" in lost
    assert mujoco.MjModel.from_xml_path(str(out)).dof_damping[0] == pytest.approx(5.5)


def test_a_model_that_is_gone_is_one_line(tmp_path, capsys):
    two_link.write_files(tmp_path)
    (machine,) = tmp_path.glob("*.toml")
    Path(tmp_path / "two_link.xml").unlink()
    assert main(["info", "--plant", str(machine), "--mjcf", str(tmp_path / "out.xml")]) == 2
    assert "two_link.xml" in capsys.readouterr().err
    assert not (tmp_path / "out.xml").exists()


def test_an_export_goes_over_no_file_of_its_machine(tmp_path, capsys):
    two_link.write_files(tmp_path)
    (machine,) = tmp_path.glob("*.toml")
    before = {path: path.read_text() for path in (machine, tmp_path / "two_link.xml")}
    for out in before:
        assert main(["info", "--plant", str(machine), "--mjcf", str(out)]) == 2
        assert "another file than those of the machine" in capsys.readouterr().err
    assert {path: path.read_text() for path in before} == before


@pytest.mark.parametrize("compiler", ["boundmass='3'", "inertiafromgeom='true'"])
def test_a_model_that_would_be_read_otherwise_is_not_written(tmp_path, compiler):
    rig = two_link.rig(tmp_path)
    path = tmp_path / "two_link.xml"
    text = path.read_text().replace('<mujoco model="two_link">', f"<mujoco><compiler {compiler}/>")
    path.write_text(text)
    light = Setting.model_validate({"body": "hook", "attribute": "mass", "value": 0.3})
    told = rig.description.model_copy(update={"parameters": (light,)})
    with pytest.raises(InvalidInputError, match=compiler.partition("=")[0]):
        mjcf_of(Rig(told, tmp_path), tmp_path)


@pytest.mark.parametrize(
    ("actuator", "limit"),
    [
        ("", ""),
        ('<motor joint="swing" forcerange="-5 5"/>', ""),
        ('<motor joint="swing"/>', 'actuatorfrcrange="-5 5"'),
    ],
)
def test_an_offset_that_no_free_motor_can_give_is_not_in_the_file(actuator, limit, tmp_path):
    (tmp_path / "swing.xml").write_text(
        f'<mujoco><worldbody><body><joint name="swing" {limit}/><geom size="0.1"/></body></worldbody>'
        f"<actuator>{actuator}</actuator></mujoco>"
    )
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "swing.xml"))
    assert bias_of(ForceOffset("swing", 0.1), model) is None
