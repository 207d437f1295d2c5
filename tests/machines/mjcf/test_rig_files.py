"""Files of a rig: bad input is one line with the nearest match; what is written loads again."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from two_link import programme, write_files

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError, VesTwinError
from ves_twin.core.recording.recording import POSES
from ves_twin.core.resources import resource_folder
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.verdict import Basis, Kind, Statistics, Verdict
from ves_twin.machines.data_folder import find_data
from ves_twin.machines.load import open_machine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate
from ves_twin.machines.mjcf.rig.extend import extended, write_rig
from ves_twin.machines.mjcf.rig.load_description import is_rig, shipped_rigs
from ves_twin.machines.mjcf.rig.machine import Rig

LOG = "t,f,m,set,x,a,fx,fy,fz\n" + "\n".join(
    f"{0.01 * k:.2f},{k},1,0,0.5,0,1,2,3" for k in range(300)
)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "backlash"', 'kind = "backlsh"', "did you mean 'backlash'"),
        ('kind = "backlash"', 'kind = "backlash"\nper_recording = true', "expected cause = false"),
        ('on = ["drive"]', 'on = ["drve"]', "did you mean 'drive'"),
        ('"load.force.1"', '"load.force"', "a column behind the signal: load.force.1"),
        ('unit = "N*m"', 'unit = "Nm"', "unknown unit 'Nm'"),
        ('attribute = "mass"', 'attribute = "mas"', "did you mean 'mass'"),
        ('sd = "0.05 kg"', 'sd = "0.05 m"', "a finite quantity in kg"),
        ("smoothing =", "smothing =", "did you mean 'drive.smoothing'"),
        ('sensor = "load"', 'sensor = "laod"', "did you mean 'load'"),
        ('joints = { rail = "cart.position"', 'joints = { rail = "cart.positon"', "cart.position"),
        ('model = "two_link.xml"', 'model = "two.xml"', "is missing"),
        ('mode = "control"', 'mode = "contrl"', "'motion', 'control' or 'reference'"),
        ("schema = 1", "schema = 9", "schema version 9"),
        ('speed = "0.5 m/s"', "", "typical.joint.rail.speed"),
        ('columns = ["fx", "fy", "fz"]', 'columns = ["fx", "fy"]', "3, as sensor load has it"),
        ('columns = ["fx", "fy", "fz"]', 'columns = ["fz"]', 'axis = "z" for one of them'),
        ('sensor = "load"', 'joint = "rail"\naxis = "z"', "axis 'z' without a sensor"),
        ('columns = ["x"]', 'columns = ["x", "y"]', "1, as joint rail has it"),
        ('columns = ["set"]', 'columns = ["f", "set"]', "1, as controllers.drive has it"),
        ("[start.rail]", '[start.rail]\nposition = "mesured"', "start.rail.position"),
        ("[start.rail]", '[start.rail]\nspeed = "3 deg/s"', "a finite quantity in m/s"),
        (
            "[drift]",
            "[present.body_mass.arm]\nmass = 1\n[drift]",
            'body = "arm", attribute = "mass"',
        ),
        (
            "[drift]",
            '[present.mass_centre."arm.x"]\nshift = 0.1\n[drift]',
            'body = "arm", attribute = "centre_x"',
        ),
        ('value = "3.1 kg"', 'value = "-3.1 kg"', "more than zero"),
        ('attribute = "mass"\nvalue = "3.1 kg"', 'attribute = "mass"\nvalue = 0', "more than zero"),
        (
            'body = "cart"\nattribute = "mass"\nvalue = "3.1 kg"\nsd = "0.05 kg"',
            'joint = "rail"\nattribute = "damping"\nvalue = -4',
            "zero or more",
        ),
        ("[drift]", "[present.body_inertia.arm]\nshare = -1.5\n\n[drift]", "at least -0.99"),
        ("noise = 0.05", "noise = [0.05, 0.05]", "one number, or 3 as it has columns"),
    ],
)
def test_a_wrong_file_is_answered_with_one_line(tmp_path, capsys, old, new, words):
    path = write_files(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    (tmp_path / "log.csv").write_text(LOG)
    assert main(["compare", str(tmp_path / "log.csv"), "--plant", str(path)]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        (("drive",), 0.5),
        (("compare",), 0.5),
        (("drive", "joints"), 0.5),
        (("drive", "actuators"), ["motor"]),
        (("signals", "cart.position", "joint"), ["rail"]),
    ],
)
def test_a_part_of_another_kind_is_refused_by_name(tmp_path, keys, value):
    path = write_files(tmp_path)
    content = tomllib.loads(path.read_text())
    if keys[0] == "signals":
        del content["compare"][keys[1]]
    part = content
    for key in keys[:-1]:
        part = part.setdefault(key, {})
    part[keys[-1]] = value
    path.write_bytes(tomli_w.dumps(content).encode())
    with pytest.raises(InvalidInputError, match=keys[-1]):
        Rig.load(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("t,f,", "time,f,", "unknown column of log.csv 't'"),
        ("0.05,5,", "0.03,5,", "strictly increasing"),
        (",fz", ",fzz", "did you mean 'fzz'"),
        (LOG.split("\n", 1)[1], "", "0 rows"),
    ],
)
def test_a_wrong_log_is_answered_with_one_line(tmp_path, capsys, old, new, words):
    path = write_files(tmp_path)
    assert old in LOG
    (tmp_path / "log.csv").write_text(LOG.replace(old, new, 1))
    assert main(["diagnose", str(tmp_path / "log.csv"), "--plant", str(path)]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error


@pytest.mark.parametrize("noise", ["", "noise = 0", "noise = -1e-5"])
def test_a_diagnosis_asks_for_the_noise_of_what_it_weighs_and_a_comparison_does_not(
    tmp_path, capsys, noise, request
):
    if noise:  # its page is drawn once
        request.getfixturevalue("unpictured")
    path = write_files(tmp_path)
    path.write_text(path.read_text().replace("noise = 1e-5", noise, 1))
    (tmp_path / "log.csv").write_text(LOG)
    words = [str(tmp_path / "log.csv"), "--plant", str(path), "--out", str(tmp_path / "out")]
    assert main(["compare", *words]) == 0
    assert main(["diagnose", *words]) == 2
    assert "signals.cart.position.noise" in capsys.readouterr().err


def test_dry_friction_of_a_given_motion_asks_for_the_typical_speed_when_the_rig_is_read(tmp_path):
    path = write_files(tmp_path, "motion", kinds={})
    begin, end = "[typical.joint.rail]", "[typical.joint.swing]"
    head, _, tail = path.read_text().partition(begin)
    path.write_text(head + end + tail.partition(end)[2])
    with pytest.raises(VesTwinError, match=r"typical\.joint\.rail\.speed"):
        Rig.load(str(path))
    # the speed alone will do
    path.write_text(head + begin + '\nspeed = "0.5 m/s"\n' + end + tail.partition(end)[2])
    assert np.isfinite(MjcfForward.of(Rig.load(str(path))).simulate(programme(), {})).all()


def test_a_rig_is_told_from_a_form_of_ves_ii(tmp_path):
    assert is_rig(str(write_files(tmp_path)))
    assert shipped_rigs() == ["emps", "ft_wrist", "pendulum"]
    assert all(is_rig(name) for name in shipped_rigs())
    assert not is_rig("ves2")


@pytest.mark.parametrize("name", shipped_rigs())
def test_every_rig_that_comes_with_the_twin_loads(name):
    """A set of rigs, or any other file that is none, does not lie among them."""
    assert Rig.load(name).description.name == name


def test_rigs_that_moved_are_still_found_where_they_were():
    for name in ("emps", "ft_wrist"):
        before, now = Rig.load(f"models/rigs/{name}.toml"), Rig.load(name)
        assert before.identity == now.identity


def test_a_set_of_rigs_is_no_rig(tmp_path, capsys):
    assert not is_rig("train-v0")
    (tmp_path / "log.csv").write_text(LOG)
    assert main(["compare", str(tmp_path / "log.csv"), "--plant", "train-v0"]) == 2
    assert "train-v0" in capsys.readouterr().err


def test_columns_become_si_and_a_vector_turns_into_its_frame(tmp_path):
    path = write_files(tmp_path)
    text = path.read_text().replace('columns = ["x"]', 'columns = ["x"]\nscale = 0.001\noffset = 2')
    quaternion = '[signals."load.turn"]\ncolumns = ["q1", "q2", "q3", "q4"]\nunit = "1"\n'
    text = text.replace('unit = "N"\nnoise = 0.05', 'unit = "N"\ninto = "load.turn"\nnoise = 0.05')
    path.write_text(text.replace("[drive]", f"{quaternion}\n[drive]", 1))
    half = np.sqrt(0.5)  # sensor turned by +90 deg about z of the world
    lines = [f"{line},0,0,{half},{half}" for line in LOG.splitlines()[1:]]
    (tmp_path / "log.csv").write_text("\n".join(["t,f,m,set,x,a,fx,fy,fz,q1,q2,q3,q4", *lines]))
    found = read_rig_recording(tmp_path / "log.csv", Rig.load(str(path)))
    assert found["cart.position"][0, 0] == pytest.approx(2.0005)
    # R' (1, 2, 3) for R = turn by 90 deg about z
    assert found["load.force"][0] == pytest.approx([2.0, -1.0, 3.0])


def test_stretches_alternate_and_poses_keep_their_order(tmp_path):
    path = write_files(tmp_path)
    (tmp_path / "log.csv").write_text(LOG)
    recording = read_rig_recording(tmp_path / "log.csv", Rig.load(str(path)))
    fitted, held = alternate(recording, 0.5)
    assert [float(r.time[0]) for r in fitted] == pytest.approx([0.0, 1.0, 2.0])
    assert [float(r.time[0]) for r in held] == pytest.approx([0.5, 1.5, 2.5])
    poses = replace(recording, time=np.arange(300.0), info=replace(recording.info, log=POSES))
    (fitted,), (held,) = alternate(poses, 10.0)
    assert list(fitted.time[:12]) == [*range(10), 20, 21]
    assert list(held.time[:2]) == [10, 11]
    with pytest.raises(VesTwinError, match="two stretches"):
        alternate(recording, 5.0)


def test_an_extended_rig_is_written_as_a_file_that_loads_as_the_same_rig(tmp_path):
    rig = Rig.load(str(write_files(tmp_path)))
    sizes = {"coulomb_friction@rail:level": 1.25, "mass_centre@arm.x:shift": 0.06}
    sizes |= {f"sensor_wander@load.force.3:p{k}": 0.1 * k for k in (1, 2, 3)}
    sizes |= {"backlash@swing:gap": 0.01}
    causes = tuple(
        Cause(
            kind_target.partition("@")[0],
            kind_target.partition("@")[2],
            {n: Estimate(v, v, v, "1", 0.0) for n, v in sizes.items() if n.startswith(kind_target)},
            1.0,
            True,
            None,
        )
        for kind_target in dict.fromkeys(n.rpartition(":")[0] for n in sizes)
    )
    tuned = {"body_mass@cart:mass": Estimate(3.15, 3.1, 3.2, "kg", 3.1)}
    basis, figures = Basis("declared", "declared", "none"), Statistics(0, 1, 0, 1)
    verdict = Verdict(Kind.SEVERAL, basis, figures, causes, tuned=tuned)
    new = extended(rig, verdict)
    folder = tmp_path / "out"
    folder.mkdir()
    write_rig(new, folder / "plant.toml", "two\nlines")
    again = Rig.load(str(folder / "plant.toml"))
    nominal = {p.name: p.nominal for p in again.parameters}
    for name, value in {**sizes, "body_mass@cart:mass": 3.15}.items():
        assert nominal[name] == pytest.approx(value, abs=1e-12), name
    # an extension of an extension
    write_rig(again, folder / "more.toml")
    assert {p.name: p.nominal for p in Rig.load(str(folder / "more.toml")).parameters} == nominal


def test_public_data_are_found_by_folder_and_checked_by_content(tmp_path, monkeypatch):
    rig = Rig.load("emps")
    monkeypatch.delenv("VES_TWIN_DATA", raising=False)
    with pytest.raises(VesTwinError, match="Janot"):
        find_data("emps/emps_train.csv", rig.description.data)
    (tmp_path / "emps").mkdir()
    Path(tmp_path, "emps", "emps_train.csv").write_text("t_s\n0\n")
    with pytest.raises(VesTwinError, match="another checksum"):
        find_data("emps/emps_train.csv", rig.description.data, str(tmp_path))


def test_a_model_that_mujoco_cannot_move_is_refused_in_one_line(tmp_path):
    for name in ("emps.toml", "emps.xml"):
        text = (resource_folder("models/machines/emps") / name).read_text()
        (tmp_path / name).write_text(text.replace('mass="90"', f'mass="1{40 * "0"}"'))
    with pytest.raises(VesTwinError, match="a model that can move") as caught:
        Rig.load(str(tmp_path / "emps.toml"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["axis.xml", "axis.URDF"])
def test_a_model_alone_is_no_machine_and_the_way_to_one_is_said(tmp_path, name):
    (tmp_path / name).write_text("<mujoco/>")
    with pytest.raises(InvalidInputError, match=f"`ves-twin new {name} LOG` drafts one"):
        open_machine(str(tmp_path / name))
