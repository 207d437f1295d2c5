"""Motion imposed on some joints while others are integrated, against the whole simulation."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from two_link import TIME, programme, write_files

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.inputs.excitations import offered
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

BOTH = 'joints = { rail = "cart.position", swing = "arm.angle" }'
EACH = 'actuators = { drive = "drive.force", hinge = "hinge.torque" }'
HINGE = 'actuators = { hinge = "hinge.torque" }'


def told(folder, mode: str, *changes: tuple[str, str]) -> Rig:
    """The rig with lines of its file replaced."""
    path = write_files(folder, mode)
    text = path.read_text()
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text)
    return Rig.load(str(path))


def moved(rig: Rig, fed: Excitation) -> dict[str, np.ndarray]:
    forward = MjcfForward.of(rig)
    rows = forward.simulate(fed, {})
    return {c.name: rows[:, [k]] for k, c in enumerate(forward.channels)}


def test_a_joint_that_moves_as_recorded_swings_the_other_and_needs_the_force_that_moved_it(
    tmp_path,
):
    """The cart is driven by a force; then its motion is imposed, and the force comes back."""
    fed = programme()
    whole = moved(told(tmp_path, "control"), fed)
    seen = {**fed.drive, "cart.position": whole["cart.position"]}
    clean = 'smoothing = "60 Hz"', 'smoothing = "240 Hz"'  # no noise: nothing is low-passed
    lines = (BOTH, f'{BOTH}\nimposed = ["rail"]'), (EACH, HINGE), clean
    part = told(tmp_path, "control", *lines)
    forward = MjcfForward.of(part)
    assert set(forward.fed) == {"hinge.torque", "cart.position"}
    assert "cart.position" not in forward.compared
    assert "hinge.torque" not in forward.compared
    found = moved(part, Excitation("imposed", TIME, seen))
    # rows of 2 ms show neither the begin of the push nor where friction turns its sign
    assert found["arm.angle"] == pytest.approx(whole["arm.angle"], abs=4e-4)
    speed = np.gradient(whole["cart.position"][:, 0], TIME)
    rows = np.arange(200, len(TIME) - 200)
    sliding = rows[np.abs(speed[rows]) > 0.05]
    asked = np.interp(TIME - 0.001, TIME, fed.drive["drive.force"][:, 0])
    gap = (found["drive.force"][:, 0] - asked)[sliding]
    assert np.sqrt(np.mean(gap**2)) < 0.3  # as of the whole inverse: soft friction, 2 % of 15 N


def test_imposed_motion_swings_the_arm_as_the_equation_of_motion_says(tmp_path):
    """(I + m l^2) a'' + c a' + k a + m g l sin a = m l x'' cos a of the hanging arm, no torque."""
    lines = (BOTH, f'{BOTH}\nimposed = ["rail"]'), (EACH, HINGE)
    rig = told(tmp_path, "control", *lines)
    x = 0.05 * (1.0 - np.cos(6.0 * TIME))
    fed = programme().drive
    still = {**fed, "cart.position": x[:, None], "hinge.torque": 0.0 * fed["hinge.torque"]}
    found = moved(rig, Excitation("shaken", TIME, still))["arm.angle"][:, 0]
    model = rig.model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    arm, dof = model.body("arm").id, int(model.joint("swing").dofadr[0])
    mass, about = float(model.body_subtreemass[arm]), float(model.dof_M0[dof])
    place = data.subtree_com[arm] - data.xpos[arm]
    length, lean = float(np.hypot(place[0], place[2])), np.arctan2(place[0], -place[2])
    angle, rate, step = 0.0, 0.0, TIME[1] / 20.0
    path = np.zeros(len(TIME))
    for k in range(len(TIME)):
        path[k] = angle
        for n in range(20):
            pull = 0.05 * 36.0 * np.cos(6.0 * (TIME[k] + n * step))
            turned = lean - angle  # positive about y swings the arm back
            torque = mass * length * (9.81 * np.sin(turned) + pull * np.cos(turned)) - 0.1 * rate
            rate += step * (torque - 0.02 * angle) / about
            angle += step * rate
    assert np.max(np.abs(path)) > 0.2
    # a step of 1 ms against 0.1 ms: 1 % of the swing
    assert found == pytest.approx(path, abs=0.01 * np.max(np.abs(path)))


def test_imposed_motion_under_runge_kutta_is_that_of_fine_steps(tmp_path):
    """An acceleration held over a step belongs to its middle: 4 ms late is 1 % of the force."""
    lines = (BOTH, f'{BOTH}\nimposed = ["rail"]'), (EACH, HINGE)
    time = 0.008 * np.arange(500)
    x = 0.05 * (1.0 - np.cos(6.0 * time))
    fed = {"cart.position": x[:, None], "hinge.torque": np.zeros((len(time), 1))}
    found = {}
    for sort, option in (
        ("fine", 'timestep="0.0001" integrator="implicitfast"'),
        ("coarse", 'timestep="0.008" integrator="RK4"'),
    ):
        folder = tmp_path / sort
        folder.mkdir()
        told(folder, "control", *lines, ('"60 Hz"', '"20 Hz"'))
        model = folder / "two_link.xml"
        plain = 'timestep="0.001" integrator="implicitfast"'
        model.write_text(model.read_text().replace(plain, option))
        rig = Rig.load(str(folder / "two_link.toml"))
        found[sort] = moved(rig, Excitation("shaken", time, fed))
    for name in ("arm.angle", "drive.force"):
        fine, coarse = (found[sort][name][20:-20] for sort in ("fine", "coarse"))
        assert np.sqrt(np.mean((coarse - fine) ** 2)) < 2e-3 * np.std(fine)


def test_a_joint_without_a_motion_is_refused_by_name(tmp_path):
    alone = (BOTH, 'joints = { rail = "cart.position" }')
    with pytest.raises(InvalidInputError, match=r"joint swing, mode 'motion'.*drive.locked"):
        told(tmp_path, "motion", alone)


def test_a_locked_joint_stands_where_the_model_has_it(tmp_path):
    alone = 'joints = { rail = "cart.position" }\nlocked = ["swing"]'
    fed = programme().drive
    still = Excitation("still", TIME, {**fed, "arm.angle": 0.0 * fed["arm.angle"]})
    by_word = moved(told(tmp_path, "motion", (BOTH, alone)), still)
    by_rows = moved(told(tmp_path, "motion"), still)
    assert by_word["drive.force"] == pytest.approx(by_rows["drive.force"], abs=1e-9)
    drive = EACH, 'actuators = { drive = "drive.force" }'
    forward = told(tmp_path, "control", (BOTH, alone), drive)
    assert np.max(np.abs(moved(forward, programme())["arm.angle"])) < 1e-6


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ('imposed = ["rial"]', UnknownNameError, "rail"),
        ('imposed = ["rail"]', InvalidInputError, "actuator drive.*joint rail either"),
        ('imposed = ["rail"]\nlocked = ["rail"]', InvalidInputError, "not locked"),
        ('locked = ["swnig"]', UnknownNameError, "swing"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, change, error, words):
    with pytest.raises(error, match=words):
        told(tmp_path, "control", (BOTH, f"{BOTH}\n{change}"))


def test_excitations_of_mixed_inputs_move_the_imposed_joint_and_drive_the_other(tmp_path):
    lines = (BOTH, f'{BOTH}\nimposed = ["rail"]'), (EACH, HINGE)
    rig = told(tmp_path, "control", *lines)
    forward = MjcfForward.of(rig)
    (one, *_) = offered(forward, seconds=4.0)
    assert set(one.drive) >= {"cart.position", "hinge.torque"}
    travel = np.ptp(one.drive["cart.position"])
    assert 0.0 < travel <= 2.0
    assert np.all(np.isfinite(forward.simulate(one, {})))
