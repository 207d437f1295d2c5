"""Payload, cross-talk, ripple, Dahl's friction on a machine: against models that have them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from arm import arm, motion
from numpy.testing import assert_allclose

from ves_twin.core.errors import VesTwinError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects import BodyMass, MassCentre, Payload
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.extend import write_rig
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import place_of

OFFERED = {"ripple": "a.12 a.24", "dahl_friction": "b", "payload": "two", "actuator_deadband": "ma"}
TALK = '[[effects]]\nkind = "drive_cross_talk"\non = ["ma from mb", "mb from ma"]\n'
EACH = {
    "ripple": {"ripple@a.12:cosine": 0.3, "ripple@a.12:sine": -0.2, "ripple@a.24:sine": 0.1},
    "dahl": {"dahl_friction@b:level": 0.4, "dahl_friction@b:travel": 0.02},
    "talk": {"drive_cross_talk@ma from mb:share": 0.25, "drive_cross_talk@mb from ma:share": -0.1},
    "payload": {"payload@two:mass": 0.7, "payload@two:x": 0.2, "payload@two:y": -0.1},
}

SPATIAL = """
<mujoco><worldbody>
  <body name="one"><joint name="a" axis="0 1 0"/><geom type="capsule" size="0.05" mass="2"
        fromto="0 0 0 0.4 0.1 0.2"/>
    <body name="two" pos="0.4 0 0" quat="0.8 0.4 0 0.4"><joint name="b" axis="0 0 1"/>
      <geom type="capsule" size="0.03" mass="1.3" fromto="0 0 0 0.1 0.2 0.3"/>{}</body></body>
</worldbody></mujoco>
"""


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return arm(tmp_path_factory.mktemp("arm"), OFFERED, TALK)


def fed(*names: str) -> Excitation:
    time, columns = motion(4.0, 1)
    return Excitation("", time, {n: columns[:, [k]] for k, n in enumerate(names)})


@pytest.mark.parametrize("kind", EACH)
def test_the_torques_that_a_simulated_motion_needs_are_those_that_moved_it(
    machine: Rig, kind: str
) -> None:
    """By integration, and back by inverse dynamics; without the effect they are others."""
    driven = fed("ta", "tb")
    path = MjcfForward.of(machine, Mode.CONTROL).simulate(driven, EACH[kind])
    moved = Excitation("", driven.time, {"qa": path[:, [0]], "qb": path[:, [1]]})
    torques = np.hstack([*driven.drive.values()])
    # a command is held over its row of 20 ms: what a row needs is the mean of two
    asked = 0.5 * (torques[1:] + torques[:-1])
    inner = slice(15, -15)  # rows that the ends of a zero-phase filter do not reach
    off = [
        np.linalg.norm((MjcfForward.of(machine).simulate(moved, values)[1:] - asked)[inner])
        for values in (EACH[kind], {})
    ]
    assert off[0] < 0.05 * off[1]


def with_payload(mass: float, *place: float) -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """By the effect, and by a body that is welded to it."""
    edited = mujoco.MjModel.from_xml_string(SPATIAL.format(""))
    Payload("two", mass, *place).edit_model(edited)
    mujoco.mj_setConst(edited, mujoco.MjData(edited))
    spec = mujoco.MjSpec.from_string(SPATIAL.format(""))
    point = spec.body("two").add_body(pos=place, mass=mass, ipos=[0.0] * 3, inertia=[0.0] * 3)
    point.explicitinertial = True
    return edited, spec.compile()


def test_a_payload_is_a_point_mass_that_is_welded_to_the_body() -> None:
    """The inverse dynamics of a turned body with axes of its own, at any state."""
    efforts = []
    for model in with_payload(0.6, 0.2, -0.1, 0.3):
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:], data.qacc[:] = (0.4, -0.7), (1.5, -2.0), (3.0, 5.0)
        mujoco.mj_inverse(model, data)
        efforts.append(data.qfrc_inverse.copy())
    assert_allclose(*efforts, rtol=1e-10)


@pytest.mark.parametrize("effect", [Payload("disc", 0.5, 0.2), MassCentre("disc.x", 0.05)])
def test_a_balanced_disc_may_come_out_of_balance(tmp_path: Path, effect: object) -> None:
    """A body on its joint's axis, which MuJoCo simplifies, until a weight pulls it to one side."""
    (tmp_path / "disc.xml").write_text(
        '<mujoco><worldbody><body name="disc"><joint name="hub" axis="0 1 0"/>'
        '<geom type="sphere" size="0.1" mass="2"/></body></worldbody>'
        '<actuator><motor name="motor" joint="hub"/></actuator></mujoco>'
    )
    (tmp_path / "disc.toml").write_text(
        'schema = 1\nkind = "rig"\nname = "disc"\nmodel = "disc.xml"\nclock = { column = "t" }\n'
        'drive = { mode = "motion", joints = { hub = "q" } }\n'
        'signals.q = { columns = ["q"], unit = "rad" }\n'
        'signals.t = { columns = ["m"], unit = "N*m", noise = 0.1, actuator = "motor" }\n'
        "typical.joint.hub = { effort = 1, speed = 1, travel = 1 }\n"
        f'effects = [{{ kind = "{effect.kind}", on = ["{effect.target}"] }}]\n'
    )
    time = 0.01 * np.arange(50)
    still = Excitation("", time, {"q": np.zeros((50, 1))})
    name = f"{effect.kind}@{effect.target}"
    sizes = {f"{name}:{size}": value for size, value in effect.values.items()}
    torque = MjcfForward.of(Rig.load(str(tmp_path / "disc.toml"))).simulate(still, sizes)
    assert torque[:, 0] == pytest.approx(-9.81 * 0.1)  # 0.5 kg at 0.2 m, 2 kg at 0.05 m


@pytest.mark.parametrize("mode", [Mode.MOTION, Mode.CONTROL])
def test_drives_that_talk_are_fed_with_a_mixture_of_their_commands(
    machine: Rig, mode: Mode
) -> None:
    """u = needed where motion is fed in, reached = u + share u elsewhere, both drives at once."""
    mixed = np.array([[1.0, 0.25], [-0.1, 1.0]])
    forward, talk = MjcfForward.of(machine, mode), EACH["talk"]
    if mode is Mode.MOTION:
        programme = fed("qa", "qb")
        needed = forward.simulate(programme, {}) @ np.linalg.inv(mixed).T
        assert_allclose(forward.simulate(programme, talk), needed, atol=1e-12)
        return
    programme = fed("ta", "tb")
    by_hand = np.hstack([*programme.drive.values()]) @ mixed.T
    same = Excitation("", programme.time, {"ta": by_hand[:, [0]], "tb": by_hand[:, [1]]})
    assert_allclose(forward.simulate(programme, talk), forward.simulate(same, {}), atol=1e-9)


def test_what_a_drive_picks_up_acts_behind_its_dead_band(machine: Rig) -> None:
    forward, programme = MjcfForward.of(machine), fed("qa", "qb")
    plain = forward.simulate(programme, {})
    band, talk = {"actuator_deadband@ma:band": 0.4}, "drive_cross_talk@ma from mb:share"
    found = forward.simulate(programme, {**band, talk: 0.2})
    own = plain[:, 0] - 0.2 * plain[:, 1]
    assert_allclose(found[:, 0], own + 0.4 * np.sign(own), atol=1e-12)


def test_a_written_machine_has_what_was_found(machine: Rig, tmp_path: Path) -> None:
    present = {
        "ripple": {"a.24": {"cosine": 0.3, "sine": -0.2}},
        "dahl_friction": {"b": {"level": 0.4, "travel": 0.02}},
        "drive_cross_talk": {"mb from ma": {"share": 0.15}},
        "payload": {"two": {"mass": 0.7, "x": 0.2, "y": -0.1, "z": 0.0}},
    }
    told = machine.description.model_copy(update={"present": present})
    write_rig(Rig(told, machine.folder, machine.file), tmp_path / "found.toml")
    values = {
        f"{kind}@{target}:{size}": value
        for kind, targets in present.items()
        for target, sizes in targets.items()
        for size, value in sizes.items()
    }
    found = MjcfForward.of(Rig.load(str(tmp_path / "found.toml")))
    programme = fed("qa", "qb")
    expected = MjcfForward.of(machine).simulate(programme, values)
    assert np.array_equal(found.simulate(programme, {}), expected)


def test_these_are_offered_where_a_file_asks_and_talk_between_neighbours(tmp_path: Path) -> None:
    every = {h.effect for h in arm(tmp_path, {"*": "*"}).hypotheses}
    assert not every & {"ripple", "dahl_friction", "drive_cross_talk", "payload"}
    targets = [h.target for h in arm(tmp_path, {"drive_cross_talk": "*"}).hypotheses]
    assert targets == ["ma from mb", "mb from ma"]


@pytest.mark.parametrize(
    ("kind", "target", "words"),
    [
        ("ripple", "c.12", "unknown joint 'c'"),
        ("drive_cross_talk", "ma from mc", "unknown actuator 'mc'"),
        ("payload", "three", "unknown body 'three'"),
    ],
)
def test_a_place_that_is_not_there_is_named(
    tmp_path: Path, kind: str, target: str, words: str
) -> None:
    more = f'[[effects]]\nkind = "{kind}"\non = ["{target}"]\n'
    with pytest.raises(VesTwinError, match=words):
        arm(tmp_path, {}, more)


CHAIN = """
<mujoco><worldbody>
  <body name="one"><joint axis="0 0 1"/><geom size="0.1" mass="4"/>
    <body name="two"><joint axis="0 1 0"/><geom size="0.1" mass="3"/>
      <body name="three">{}<geom size="0.1" mass="2"/></body></body></body>
</worldbody></mujoco>
"""


@pytest.mark.parametrize(
    ("joint", "body", "largest"),
    [
        ('<joint axis="1 0 0"/>', "three", 6.0),
        ('<joint axis="1 0 0"/>', "two", 1.5),
        ("", "three", 1.0),
    ],
)
def test_the_last_body_of_an_arm_may_weigh_what_a_tool_weighs(joint, body, largest):
    """Three joints make an arm; of any other body up to half may be undeclared."""
    model = mujoco.MjModel.from_xml_string(CHAIN.format(joint))
    effect = BodyMass(body)
    (mass,) = effect.magnitudes_at(place_of(effect, None, model))
    assert mass.largest == pytest.approx(largest)


def test_the_largest_payload_of_a_file_is_its_mass_and_says_nothing_of_its_place(tmp_path):
    """A payload covers what mass and inertia of its body would say: "*" adds neither."""
    more = '[[effects]]\nkind = "payload"\non = ["two"]\nlargest = "9 kg"\n'
    more += '[[effects]]\nkind = "*"\non = ["*"]\n'
    rig = arm(tmp_path, {}, more)
    high = {p.name: p.high for p in rig.parameters}
    assert high["payload@two:mass"] == 9.0
    assert [high[f"payload@two:{axis}"] for axis in "xyz"] == [0.5] * 3
    on_two = {h.effect for h in rig.hypotheses if h.target == "two"}
    assert "payload" in on_two
    assert not on_two & {"body_mass", "body_inertia"}
    assert {"body_mass", "body_inertia"} <= {h.effect for h in rig.hypotheses if h.target == "one"}
