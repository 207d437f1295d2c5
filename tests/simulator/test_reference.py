"""The zero-g reference is the emulated base with the arm on it, checked against other means."""

import mujoco
import numpy as np

import ves_twin as vt
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.assembly import assemble_free_arm
from ves_twin.simulator import reference as module
from ves_twin.simulator.arm_commands import arm_motion
from ves_twin.simulator.reference import ZeroGravityReference

CYCLE = 37 * 341e-6
Q = np.array([0.3, 0.4, -0.5])


def servo_block() -> np.ndarray:
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 0.1, "run.settle": 0.1})
    return vt.Simulator(None, scenario).rig.parameters["servo"]


def released(system: EmulatedSystem, start: np.ndarray, cycles: int) -> np.ndarray:
    plant = vt.Plant.load("ves2")
    ref = ZeroGravityReference(plant, system, servo_block(), start, np.zeros(6), Q)
    poses, _, _ = ref.advance(np.tile(Q, (cycles - 1, 4, 1)), CYCLE)
    return poses


def test_diagonal_base_agrees_with_mujoco_springs_and_armature(figure):
    """MuJoCo has joint springs, dampers and armature, so it can hold a diagonal M, B, K."""
    system = EmulatedSystem.load("table_5_2")
    start = np.array([0.05, -0.04, 0.03, 0.02, -0.02, 0.01])
    ours = released(system, start, 240)
    plant = vt.Plant.load("ves2")
    spec = assemble_free_arm(plant)
    names = ("x", "y", "z", "rx", "ry", "rz")
    for i, name in enumerate(names):
        joint = spec.joint(name)
        joint.armature = system.mass[i, i]
        joint.damping = np.array([system.damping[i, i], 0, 0])
        joint.stiffness = np.array([system.stiffness[i, i], 0, 0])
    table = plant.parameters
    spec.option.timestep = 341e-6
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    for j in range(3):
        joint = spec.joint(f"arm/q{j + 1}")
        joint.stiffness = np.array([table.array("servo.stiffness")[j], 0, 0])
        joint.damping = joint.damping + np.array([table.array("servo.damping")[j], 0, 0])
        joint.springref = Q[j]
    model = spec.compile()
    data = mujoco.MjData(model)
    for i, name in enumerate(names):
        data.joint(name).qpos[0] = start[i]
    data.qpos[6:] = Q
    theirs = []
    for _ in range(240):
        theirs.append([data.joint(name).qpos[0] for name in names])
        mujoco.mj_step(model, data, 37)
    difference = np.max(np.abs(ours - np.array(theirs)))
    # the two differ by E(phi) - 1 on the moments (0.02 rad) and by the servo's integrator
    figure("zero-g reference against MuJoCo's own springs", difference / 0.05 * 100, 1.0, "%")


def test_frequencies_with_the_rigid_arm_are_those_of_the_thesis_model(figure):
    """Independent linear figures for the printed horizontal beam with the PUMA at q = 0."""
    system = EmulatedSystem.load("beam_horizontal_thesis")
    undamped = EmulatedSystem(
        "undamped", system.coupling, system.mass, 0 * system.damping, system.stiffness, ""
    )
    plant = vt.Plant.load("ves2")
    servo = servo_block().copy()
    for name in ("stiffness", "damping", "integral"):  # a rigid arm has no servo dynamics
        servo[name] = servo[name] * (100.0 if name != "integral" else 0.0)
    servo["limit"] = 1e9
    size = 12
    transition = np.zeros((size, size))
    for column in range(size):
        ends = []
        for sign in (1.0, -1.0):
            start = np.zeros(6)
            ref = ZeroGravityReference(plant, undamped, servo, start, np.zeros(6), np.zeros(3))
            state = ref.snapshot()
            value = sign * 1e-5
            for offset in (0, 12):  # the base and the platform, which is the base
                state[offset + column % 6 + (6 if column >= 6 else 0)] = value
            ref.restore(state)
            ref.advance(np.zeros((4, 4, 3)), CYCLE / 4)
            ends.append(ref.snapshot()[:12])
        transition[:, column] = (ends[0] - ends[1]) / 2e-5
    poles = np.log(np.linalg.eigvals(transition).astype(complex)) / CYCLE
    found = sorted({round(abs(p.imag) / 2 / np.pi, 5) for p in poles if p.imag > 1e-3})
    expected = [0.111, 0.132, 0.158, 0.428, 5.19]  # 40 Hz aliases at this period
    worst = max(abs(f - e) / e for f, e in zip(found, expected, strict=False))
    figure(
        "zero-g base frequencies with the arm on it, against the linear figures",
        worst * 100,
        1.0,
        "%",
    )


def test_reference_converges_in_its_step(monkeypatch, figure):
    system = EmulatedSystem.load("beam_horizontal_thesis")
    start = np.array([0.0, 0.1, 0.1, 0.05, 0.0, 0.0])
    coarse = released(system, start, 400)
    monkeypatch.setattr(module, "LONGEST_STEP", module.LONGEST_STEP / 4)
    fine = released(system, start, 400)
    figure(
        "zero-g reference: change on a four times finer step",
        np.max(np.abs(coarse - fine)) * 1e6,
        5.0,
        "um",
    )


def test_base_without_spring_keeps_its_momentum(monkeypatch):
    """Free floating, no external force: the common centre of mass stays where it was."""
    system = EmulatedSystem(
        "free", EmulatedSystem.load("table_5_2").coupling, np.diag([300.0] * 3 + [80.0] * 3),
        np.zeros((6, 6)), np.zeros((6, 6)), "",
    )  # fmt: skip
    plant = vt.Plant.load("ves2")
    monkeypatch.setattr(module, "LONGEST_STEP", 2e-4)
    ref = ZeroGravityReference(plant, system, servo_block(), np.zeros(6), np.zeros(6), Q)
    model = assemble_free_arm(plant).compile()
    data = mujoco.MjData(model)

    def centre(pose: np.ndarray, q: np.ndarray) -> np.ndarray:
        data.qpos[:] = [*pose[:3], pose[5], pose[4], pose[3], *q]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        payload = float(model.body_subtreemass[0])
        return (300.0 * pose[:3] + payload * data.subtree_com[0]) / (300.0 + payload)

    targets = Q + np.outer(np.minimum(1.0, np.arange(160) / 120), [1.0, 0.5, 0.3])
    poses, _, joints = ref.advance(np.repeat(targets[:, None], 4, axis=1), CYCLE)
    assert np.linalg.norm(poses[-1, :3]) > 0.01
    # what RK4 leaves at a fine step over 2 s; the base itself moves 16 cm
    assert np.max(np.abs(centre(poses[-1], joints[-1]) - centre(poses[0], joints[0]))) < 1e-9


def test_free_floating_scenario_keeps_all_momentum_and_its_centre_of_mass(figure):
    """From rest without outer force, momentum and moment of momentum stay zero.

    The payload's come from MuJoCo's subtree sums (`armature` has none); the base adds m X' and
    J phi' + X x m X'. The centre of mass of both stays where it was, which gives the base's place in closed form.
    """
    scenario = vt.Scenario.load("free_float", {"run.settle": 0.1})
    sim = vt.Simulator(None, scenario)
    ref = sim.recorder._references["reference.pose"]
    system = EmulatedSystem.load("free_float")
    model = assemble_free_arm(sim.plant).compile()
    data, motion = mujoco.MjData(model), arm_motion(scenario)
    payload = float(model.body_subtreemass[0])
    place_error = momentum = turning = fastest = 0.0
    start, cycle = None, sim.rig.clock.admittance * sim.rig.clock.tick
    for k in range(int(4.0 / cycle)):
        points = np.array([motion.q((k + i - 1) * cycle) for i in range(4)])
        ref.advance(points[None], cycle)
        state = ref.snapshot()
        pose, rate = state[:6], state[6:12]
        data.qpos[:] = [*pose[:3], pose[5], pose[4], pose[3], *state[24:27]]
        data.qvel[:] = [*rate[:3], rate[5], rate[4], rate[3], *state[27:30]]
        mujoco.mj_forward(model, data)
        mujoco.mj_subtreeVel(model, data)
        com, velocity = data.subtree_com[0], data.subtree_linvel[0]
        base = system.mass[0, 0] * rate[:3]
        linear = base + payload * velocity
        angular = system.mass[3:, 3:] @ rate[3:] + np.cross(pose[:3], base)
        angular += data.subtree_angmom[0] + np.cross(com, payload * velocity)
        start = com - pose[:3] if start is None else start
        share = payload / (payload + system.mass[0, 0])
        place_error = max(place_error, np.max(np.abs(pose[:3] + share * (com - pose[:3] - start))))
        momentum = max(momentum, np.max(np.abs(linear)))
        turning = max(turning, np.max(np.abs(angular)))
        fastest = max(fastest, np.linalg.norm(payload * velocity))
    # what RK4 leaves at the shipped step; the payload's own momentum peaks at tens of N s
    assert fastest > 10.0
    figure(
        "free float: base against the closed form of a still centre of mass",
        place_error * 1e6,
        1.0,
        "um",
    )
    figure("free float: momentum of base and arm", momentum, 1e-3, "N s")
    figure("free float: moment of momentum of base and arm", turning, 1e-3, "N m s")


def test_platform_with_fast_legs_is_the_ideal_emulation():
    plant, system = vt.Plant.load("ves2"), EmulatedSystem.load("table_5_2")
    start = np.array([0.1, 0.0, 0.05, 0.0, 0.1, 0.0])
    ends = []
    for legs in (None, (20.0, 0.004), (80.0, 0.004)):
        ref = ZeroGravityReference(plant, system, servo_block(), start, np.zeros(6), Q, legs)
        ref.advance(np.tile(Q, (80, 4, 1)), CYCLE)
        ends.append(ref.pose)
    slow, fast = (np.linalg.norm(end - ends[0]) for end in ends[1:])
    assert fast < 0.4 * slow
