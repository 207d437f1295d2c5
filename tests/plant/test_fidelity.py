"""The fast rig is the same machine with straight legs without bodies, and refuses what it lacks."""

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.registry import EFFECTS, build_effect
from ves_twin.plant.assembly import assemble
from ves_twin.plant.fidelity import ABSENT_PARAMETERS, Fidelity
from ves_twin.plant.layout import Layout
from ves_twin.plant.modes import structural_modes
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import joints_on_platform, place_rig, static_leg_forces

ROUND_OFF = 1e-12
"""m, or relative: the same lengths and wrenches by two chains of products."""
DIFFERENCE = 1e-7
"""Relative: central difference of lengths with a step of 1e-6."""


@pytest.fixture(scope="module")
def fast(plant):
    return plant.with_fidelity("fast")


@pytest.fixture(scope="module")
def model(fast):
    return assemble(fast, 341e-6).compile()


@pytest.fixture(scope="module")
def layout(model):
    return Layout.of(model)


def placed(model, layout, plant, pose, q):
    data = mujoco.MjData(model)
    place_rig(data, layout, plant.geometry, pose, q)
    mujoco.mj_forward(model, data)
    return data


def test_the_fast_rig_has_9_degrees_of_freedom_and_no_constraints(model):
    assert (model.nv, model.nu, model.neq) == (9, 9, 0)


def test_platform_rods_and_payload_are_its_mass(model):
    assert model.body_subtreemass[0] == pytest.approx(60.0 + 6 * 2.5 + 93.7, abs=1e-9)


def test_travel_has_the_zero_and_the_sign_of_the_full_rig(rig, fast, model, layout, placements):
    home = fast.geometry.lengths(np.zeros(6))
    for pose, q in placements:
        rig.place(pose, q)
        ours = layout.slide(placed(model, layout, fast, pose, q))
        np.testing.assert_allclose(ours, rig.layout.slide(rig.data), rtol=0, atol=ROUND_OFF)
        np.testing.assert_allclose(ours, fast.geometry.lengths(pose) - home, rtol=0, atol=ROUND_OFF)


def test_speed_is_the_rate_of_travel(fast, model, layout, placements):
    rng = np.random.default_rng(3)
    step = 1e-6
    for pose, q in placements[:5]:
        data = placed(model, layout, fast, pose, q)
        data.qvel[:] = rng.normal(size=model.nv)
        mujoco.mj_forward(model, data)
        speed = layout.slide_arrays(data)[1][layout.speed_at].copy()
        ends = []
        for sign in (1.0, -1.0):
            moved = placed(model, layout, fast, pose, q)
            mujoco.mj_integratePos(model, moved.qpos, data.qvel, sign * step)
            mujoco.mj_forward(model, moved)
            ends.append(layout.slide(moved))
        np.testing.assert_allclose(speed, (ends[0] - ends[1]) / (2 * step), rtol=0, atol=DIFFERENCE)


def test_a_force_pushes_the_platform_by_the_jacobian_of_the_lengths(
    fast, model, layout, placements
):
    """F on the legs is the wrench J' F about the top, the moment in body axes."""
    rng = np.random.default_rng(4)
    for pose, q in placements[:5]:
        data = placed(model, layout, fast, pose, q)
        force = rng.normal(size=6) * 1e3
        data.ctrl[layout.leg_ctrl] = force
        mujoco.mj_forward(model, data)
        pushed = data.qfrc_actuator[layout.platform_dof :][:6].copy()
        pushed[3:] = data.site("platform/top").xmat.reshape(3, 3) @ pushed[3:]
        expected = fast.geometry.jacobian(pose).T @ force
        np.testing.assert_allclose(pushed, expected, rtol=0, atol=1e-9)  # N, N m of thousands


def test_leg_forces_that_hold_the_rig_leave_it_without_acceleration(
    fast, model, layout, placements
):
    for pose, q in placements[:5]:
        data = placed(model, layout, fast, pose, q)
        force = static_leg_forces(model, data, layout, fast.geometry, pose)
        data.ctrl[layout.leg_ctrl] = force
        data.ctrl[layout.arm_ctrl] = data.qfrc_bias[layout.arm_dof]
        mujoco.mj_forward(model, data)
        assert np.max(np.abs(data.qacc)) < 1e-9  # of 9.81 m/s^2


def test_a_rod_adds_its_mass_along_its_leg(plant):
    """Legs alone carry the rods: with twice the rods, the holding forces grow by their weight."""
    forces = []
    for mass in (2.5, 5.0):
        rig = plant.with_values({"leg.rod_mass": mass}).with_fidelity("fast")
        model = assemble(rig, 341e-6).compile()
        layout, pose = Layout.of(model), np.zeros(6)
        data = placed(model, layout, rig, pose, np.zeros(3))
        forces.append(static_leg_forces(model, data, layout, rig.geometry, pose))
    along = plant.geometry.home + plant.geometry.top - plant.geometry.base
    upward = along[:, 2] / np.linalg.norm(along, axis=1)
    np.testing.assert_allclose((forces[1] - forces[0]) * upward, 2.5 * 9.81, rtol=0, atol=1e-9)


def test_modes_are_oil_and_servos_and_none_is_bending(plant, fast):
    """What the full rig has beside bending is there within 7 %; no lightly damped mode below it."""
    pose, q = np.zeros(6), np.zeros(3)
    found = structural_modes(fast, pose, q)
    other = [m for m in structural_modes(plant, pose, q) if m.bending_share < 0.1]
    assert all(mode.bending_share == 0.0 for mode in found)
    assert all(mode.damping > 0.5 for mode in found if mode.frequency < 20.0)
    ours, theirs = ([m.frequency for m in modes] for modes in (found, other))
    np.testing.assert_allclose(ours, theirs, rtol=0.07)


@pytest.mark.parametrize("name", sorted(ABSENT_PARAMETERS))
def test_a_number_it_has_no_room_for_is_refused_by_name(plant, fast, name):
    change = {name: float(plant.parameters.number(name)) * 1.1}
    for action in (
        lambda: fast.with_values(change),
        lambda: plant.with_values(change).with_fidelity("fast"),
    ):
        with pytest.raises(InvalidInputError, match=name) as caught:
            action()
        assert "\n" not in str(caught.value)
    nominal = {name: plant.parameters.number(name)}
    assert fast.with_values(nominal).hash == fast.hash


@pytest.mark.parametrize(
    ("kind", "target"), [(k, row.targets[0]) for k in EFFECTS for row in EFFECTS[k].rows]
)
def test_every_effect_has_room_in_the_fast_rig_or_is_refused(fast, kind, target):
    magnitude = EFFECTS[kind].magnitudes_of(target)[0]
    size = magnitude.smallest * (-1 if magnitude.sign is Sign.NEGATIVE else 1)
    effect = build_effect(kind, target, {magnitude.name: size})
    try:
        extended = fast.extended(effect)
    except InvalidInputError as refusal:
        assert "\n" not in str(refusal)  # noqa: PT017  (either way is allowed)
        return
    assert extended.hash != fast.hash
    assert assemble(extended, 341e-6).compile().nv == 9


def test_a_moved_platform_joint_leaves_the_zero_of_travel_where_it_was(plant, fast):
    """The transducer does not know of it: both rigs show the change as travel."""
    effect = build_effect("anchor_position", "leg.2.z", {"offset": 0.01})
    slides = []
    for rig in (plant.extended(effect), fast.extended(effect)):
        model = assemble(rig, 341e-6).compile()
        layout, data = Layout.of(model), mujoco.MjData(model)
        top = joints_on_platform(model)
        place_rig(data, layout, rig.geometry, np.zeros(6), np.zeros(3), top)
        mujoco.mj_forward(model, data)
        slides.append(layout.slide(data))
    np.testing.assert_allclose(slides[1], slides[0], rtol=0, atol=ROUND_OFF)
    assert 0.008 < slides[1][1] < 0.01


def test_every_other_leg_number_is_taken(plant):
    taken = {n for n in plant.parameters if n.startswith("leg.")} - ABSENT_PARAMETERS
    expected = {"leg.stroke", "leg.margin", "leg.rod_mass", "leg.rod_radius", "leg.dry_friction"}
    assert taken == expected


def test_a_plant_file_names_its_fidelity(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        'schema = 1\nbase = "ves2_pressure"\nfidelity = "fast"\n[parameters]\n"leg.rod_mass" = 3.0\n'
    )
    rig = Plant.load(str(path))
    assert rig.fidelity is Fidelity.FAST
    assert rig.base == "ves2_pressure_fast"
    assert set(rig.changes()) == {"leg.rod_mass"}
    assert Plant.load(rig.base).with_values(rig.changes()).hash == rig.hash
    assert rig.hash != rig.with_fidelity("full").hash


@pytest.mark.parametrize(
    ("line", "word"),
    [('fidelity = "fsat"', "'fast'"), ('fidelity = "fast"\n[parameters]\n"leg.bending_stiffness" = 1.0', "leg.bending_stiffness")],
)  # fmt: skip
def test_a_file_that_asks_for_what_cannot_be_is_refused(tmp_path, line, word):
    path = tmp_path / "rig.toml"
    path.write_text(f'schema = 1\nbase = "ves2"\n{line}\n')
    with pytest.raises(VesTwinError) as caught:
        Plant.load(str(path))
    assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_base_that_is_no_name_is_refused_in_a_short_line(tmp_path):
    numbers = "\n".join(f"n{i} = {i}" for i in range(300))
    (tmp_path / "rig.toml").write_text(f"schema = 1\n[base]\n{numbers}\n")
    with pytest.raises(VesTwinError, match="expected the name or the path of a plant") as caught:
        Plant.load(str(tmp_path / "rig.toml"))
    assert len(str(caught.value)) < 500


def test_shipped_plants_are_named_by_their_hydraulics_and_fidelity():
    for name in ("ves2", "ves2_fast", "ves2_pressure", "ves2_pressure_fast"):
        plant = Plant.load(name)
        assert (plant.name, plant.base, plant.changes()) == (name, name, {})


def test_an_unknown_fidelity_is_answered_with_the_nearest(plant):
    with pytest.raises(UnknownNameError, match="did you mean 'fast'"):
        plant.with_fidelity("fastt")
