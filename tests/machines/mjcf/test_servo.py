"""A position servo whose loops nobody knows: what is hidden in them is named with its size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import servo_rig

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Setting
from ves_twin.machines.mjcf.rig.extend import extended
from ves_twin.machines.mjcf.rig.machine import Rig

HIDDEN = {"servo_stiffness@servo:stiffness": 5.0, "actuator_lag@servo:time": 0.09}
"""Sizes as the file has numbers: kp of 8 N m/rad in the model, a time constant of 0.06 s."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    text = servo_rig.TOML.replace(servo_rig.EFFECTS, 'effects = [{ kind = "*", on = ["*"] }]')
    return servo_rig.rig(tmp_path_factory.mktemp("servo"), text)


def recorded(machine: Rig, seed: int, values: dict[str, float]) -> Recording:
    rng, time = np.random.default_rng(seed), servo_rig.TIME
    rate, size = rng.uniform(3.0, 9.0, 3), rng.uniform(0.2, 0.5, 3)
    target = np.sin(np.outer(time, rate)) @ size
    fed = Excitation("", time, {"target": target[:, None], "angle": np.zeros((len(time), 1))})
    rows = MjcfForward.of(machine).simulate(fed, values)
    rows = rows + 1e-3 * rng.standard_normal(rows.shape)
    signals = {"target": target[:, None], "angle": rows}
    return Recording(time, signals, RecordingInfo("measured", scenario=f"motion {seed}"))


@pytest.mark.parametrize("name", HIDDEN)
def test_a_loop_that_is_otherwise_is_named_with_its_size(machine: Rig, name: str, banks: Path):
    value = HIDDEN[name]
    one, other = (recorded(machine, seed, {name: value}) for seed in (1, 2))
    settings = Settings(nulls=20, cache=banks)
    verdict = diagnose([one], machine, held_out=[other], settings=settings).verdict
    assert verdict.verdict is Kind.NAMED
    (cause,) = verdict.causes
    label, _, size = name.partition(":")
    assert f"{cause.effect}@{cause.target}" == label
    found = cause.parameters[size]
    # one of ten 90 % intervals would miss; twice as wide one in a hundred
    assert abs(found.value - value) < found.high - found.low
    plant = extended(machine, verdict)
    (own,) = (e.nominal[0] for e in plant.entries if f"{e.effect.kind}@{e.place.name}" == label)
    assert own == pytest.approx(found.value)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("servo_stiffness", "a position servo that is fed"),
        ("servo_damping", "a position servo that is fed"),
        ("servo_strength", "a position servo that is fed"),
        ("actuator_lag", "filter or filterexact"),
    ],
)
def test_a_motor_has_no_loops_of_a_servo(kind: str, words: str, tmp_path: Path):
    text = servo_rig.TOML
    for other in servo_rig.TARGETS.keys() - {kind}:
        text = text.replace(f'"{other}"', f'"{kind}"')
    model = servo_rig.MODEL.replace('biasprm="0 -8 -0.3"', "").replace('dyntype="filter"', "")
    with pytest.raises(VesTwinError, match=words):
        servo_rig.rig(tmp_path, text, model)


def test_a_servo_has_no_gain_that_would_make_another_actuator_of_it(tmp_path: Path):
    text = servo_rig.TOML.replace('"servo_stiffness"', '"actuator_gain"')
    with pytest.raises(VesTwinError, match="of a servo name servo_stiffness"):
        servo_rig.rig(tmp_path, text)


def test_an_actuator_that_integrates_a_speed_is_no_servo(tmp_path: Path):
    drive = '<intvelocity name="servo" joint="swing" kp="8" kv="0.3" actrange="-2 2"/>'
    head, _, tail = servo_rig.MODEL.partition("<general")
    model = head + drive + tail[tail.index("/>") + 2 :]
    with pytest.raises(VesTwinError, match="a position servo that is fed"):
        servo_rig.rig(tmp_path, model=model)


@pytest.mark.parametrize("name", ["servo_stiffness@servo:stiffness", "actuator_lag@servo:time"])
def test_sizes_at_the_ends_of_their_ranges_are_written_and_simulated(machine: Rig, name: str):
    """A search may end there: kp of next to nothing, a filter quicker than any log shows."""
    forward = MjcfForward.of(machine)
    (told,) = (p for p in forward.parameters if p.name == name)
    for value in (told.low, told.high):
        rows = forward.simulate(servo_rig.programme(), {name: value})
        assert np.all(np.isfinite(rows))
        setting = {"attribute": "kp" if "stiffness" in name else "timeconst", "actuator": "servo"}
        new = Setting.model_validate(setting | {"value": value})
        described = machine.description.model_copy(update={"parameters": (new,)})
        plant = Rig(described, machine.folder, machine.file)
        again = MjcfForward.of(plant).simulate(servo_rig.programme(), {})
        assert np.allclose(again, rows, atol=1e-6)  # predictions are in single precision


def test_a_star_on_a_servo_means_its_loops_and_no_dead_band_about_an_angle_of_zero(machine: Rig):
    kinds = {entry.effect.kind for entry in machine.entries}
    assert {"servo_stiffness", "actuator_lag"} <= kinds
    assert not {"actuator_deadband", "actuator_gain", "servo_damping"} & kinds


def test_a_servo_of_another_strength_pulls_brakes_and_ends_alike_stronger(tmp_path: Path):
    """Under a load that a guessed stall torque does not lift, no stiffness does the same."""
    head, _, tail = servo_rig.MODEL.partition("<general")
    drive = '<position name="servo" joint="swing" kp="8" kv="0.3" forcerange="-0.25 0.25"/>'
    weak, strong = (head + one + tail[tail.index("/>") + 2 :] for one in (drive, _times(drive)))
    text = servo_rig.TOML.replace(servo_rig.EFFECTS, 'effects = [{ kind = "*", on = ["*"] }]')
    told = servo_rig.rig(tmp_path, text, weak)
    found = MjcfForward.of(told).simulate(
        servo_rig.programme(), {"servo_strength@servo:share": 0.6}
    )
    other = MjcfForward.of(servo_rig.rig(tmp_path, text, strong))
    assert np.allclose(found, other.simulate(servo_rig.programme(), {}), atol=1e-6)
    stiffer = {"servo_stiffness@servo:stiffness": 4.8}
    held = MjcfForward.of(servo_rig.rig(tmp_path, text, weak)).simulate(
        servo_rig.programme(), stiffer
    )
    assert np.max(np.abs(found - held)) > 0.05


def _times(drive: str) -> str:
    return drive.replace('"8"', '"12.8"').replace('"0.3"', '"0.48"').replace("0.25", "0.4")


def test_a_star_means_no_strength_of_a_servo_that_has_neither_limit_nor_brake(tmp_path: Path):
    text = servo_rig.TOML.replace(servo_rig.EFFECTS, 'effects = [{ kind = "*", on = ["*"] }]')
    bare = servo_rig.rig(tmp_path, text, servo_rig.MODEL.replace("0 -8 -0.3", "0 -8 0"))
    assert "servo_strength" not in {entry.effect.kind for entry in bare.entries}


def test_the_limit_of_a_servo_s_joint_grows_with_it(tmp_path: Path):
    text = servo_rig.TOML.replace(servo_rig.EFFECTS, 'effects = [{ kind = "*", on = ["*"] }]')
    model = servo_rig.MODEL.replace("0 -8 -0.3", "0 -8 0").replace(
        'armature="0.002"', 'armature="0.002" actuatorfrcrange="-0.2 0.2"'
    )
    machine = servo_rig.rig(tmp_path, text, model)
    assert "servo_strength" in {entry.effect.kind for entry in machine.entries}
    share = {"servo_strength@servo:share": 0.5}
    found = MjcfForward.of(machine).simulate(servo_rig.programme(), share)
    other = model.replace("0.2 0.2", "0.3 0.3").replace('"8"', '"12"').replace("0 -8 0", "0 -12 0")
    rows = MjcfForward.of(servo_rig.rig(tmp_path, text, other)).simulate(servo_rig.programme(), {})
    assert np.allclose(found, rows, atol=1e-6)
