"""The fast rig agrees with the full one in every shipped scenario, and the scenarios are stable."""

import numpy as np
from shipped import each_scenario, fast_run, full_run

import ves_twin as vt
from ves_twin.report.rerun.rig import DrawnRig
from ves_twin.report.rerun.write import write_rrd
from ves_twin.scenario.load import scenario_questions
from ves_twin.simulator.emulation_error import emulation_error

SHORT = {"run.duration": 0.5, "run.settle": 0.5}
MOVE, TURN = slice(0, 3), slice(3, 6)
ENDS_EARLY = {"beam_horizontal_corrected", "operation_ceiling"}

# Largest difference of truth.pose [mm], [mrad] and of sensor.wrench [N], [N m]: a third above what
# was measured for seed 0 (docs/fidelity.md). Drift without a spring keeps every difference.
# The operator's quick moves shake the bending legs at 12 Hz, which fast has no room for.
AGREEMENT = {
    "beam_model_method": (0.46, 0.074, 20.0, 10.6),
    "teleoperation": (0.47, 0.073, 147.0, 72.0),
    "beam_horizontal_truth": (0.48, 0.08, 20.0, 10.6),
    "beam_vertical_truth": (0.42, 0.085, 60.0, 33.0),
    "bent_beam_truth": (0.72, 0.09, 8.4, 4.5),
    "free_float": (0.75, 2.5, 2.4, 1.2),
    "identify_fast": (0.048, 0.19, 23.0, 15.6),
    "identify_slow": (0.022, 0.04, 9.1, 6.1),
    "operation_recovery": (0.15, 0.14, 133.0, 68.0),  # a stop in full motion shakes the legs
    "position_sine": (0.021, 0.021, 9.0, 5.5),
    "release_table_5_2": (0.31, 0.81, 17.0, 11.2),
}
OTHERS = (1.0, 2.5, 60.0, 33.0)
"""For a scenario that has no line of its own yet."""

ERROR_AGREEMENT = 0.05
"""Rms emulation error of fast against full, relative to the worst axis of full: measured 0.02."""


def runs(name):
    """A scenario as shipped, in both fidelities, with the same noise."""
    return full_run(name)[0], fast_run(name)


@each_scenario([n for n in scenario_questions() if n not in ENDS_EARLY])
def test_fast_agrees_with_full(name, figure):
    full, fast = runs(name)
    assert full.info.outcome == fast.info.outcome == "completed"
    pose, wrench = (fast[s] - full[s] for s in ("truth.pose", "sensor.wrench"))
    limits = AGREEMENT.get(name, OTHERS)
    for gap, unit, limit in zip(
        (pose[:, MOVE] * 1e3, pose[:, TURN] * 1e3, wrench[:, MOVE], wrench[:, TURN]),
        ("mm", "mrad", "N", "N m"),
        limits,
        strict=True,
    ):
        signal = "pose" if unit.startswith("m") else "wrench"
        figure(f"fast against full in {name}: {signal}", np.abs(gap).max(), limit, unit)
    if "reference.pose" in full.signals:
        poses = ("truth.pose", "reference.pose", "reference.pose_leg_lag")
        errors = [
            np.array([e.rms for e in emulation_error([tuple(r[n] for n in poses)]).values()])
            for r in (full, fast)
        ]
        for part in (MOVE, TURN):
            worst = errors[0][part].max()
            assert np.max(np.abs(errors[1] - errors[0])[part]) < ERROR_AGREEMENT * worst


@each_scenario(sorted(ENDS_EARLY))
def test_fast_ends_where_full_ends(name):
    full, fast = runs(name)
    assert full.info.outcome == fast.info.outcome != "completed"


# Peaks of truth.pose over the run [mm, mrad], measured for seed 0, and how much of the first
# quarter's peak may be left in the last quarter. The printed bent beam on paper and in a
# prototype of the rig: 71, 69, 34 mm, 13.9, 14.3, 3.5 mrad (gain 12.6, 30 s).
PEAKS = {
    "beam_vertical_truth": ([101.6, 96.9, 0.22, 11.6, 17.1, 6.7], 0.25),
    "bent_beam_truth": ([68.2, 69.7, 32.9, 13.7, 13.8, 3.5], 0.5),
}


@each_scenario(sorted(PEAKS))
def test_motion_of_a_beam_peaks_as_stated_and_dies_away(name, figure):
    full, _ = runs(name)
    pose, (peaks, left) = full["truth.pose"] * 1e3, PEAKS[name]
    np.testing.assert_allclose(np.abs(pose).max(axis=0), peaks, rtol=0.03, atol=0.1)
    quarter = len(pose) // 4
    first, last = (
        np.abs(pose[rows, MOVE]).max() for rows in (slice(quarter), slice(-quarter, None))
    )
    figure(f"{name}: last quarter over the first", last / first, left, "")


@each_scenario([*PEAKS, "free_float"])
def test_no_vibration_is_left_at_the_end(name, figure):
    """An unstable loop may end in a limit cycle: the outcome alone would not tell."""
    pose = runs(name)[0]["truth.pose"] * 1e3
    rows = pose[-int(4.0 / 0.0126) :]
    lines = np.abs(np.fft.rfft((rows - rows.mean(axis=0)) * np.hanning(len(rows))[:, None], axis=0))
    frequency = np.fft.rfftfreq(len(rows), runs(name)[0].info.period)
    largest = (lines[frequency > 7.0] * 4.0 / len(rows)).max()
    # noise alone leaves 0.002; the limit cycles seen were 1 to 5
    figure(f"{name}: largest line above 7 Hz in the last 4 s", largest, 0.02, "mm or mrad")


@each_scenario(["free_float"])
def test_free_floating_base_answers_the_arm_and_then_drifts_by_noise(name, figure, cases):
    """Until the arm stands the reference is met; noise integrated twice leads away from it."""
    full, _ = runs(name)
    error = np.abs(full["truth.pose"] - full["reference.pose"])
    moving, late = full.time < 4.0, full.time > 25.0
    figure(
        "free_float: error of translation in the first 4 s",
        error[moving][:, MOVE].max() * 1e3,
        3.0,
        "mm",
    )
    for plant in ("ves2_fast", "ves2")[: cases(2)]:
        quiet = vt.simulate(vt.Scenario.load(name, {"run.noise": False, "plant": plant}))
        calm = np.abs(quiet["truth.pose"] - quiet["reference.pose"])
        assert calm[late].max(axis=0)[TURN].max() < 0.2 * error[late].max(axis=0)[TURN].max(), plant


def test_the_fast_recording_lacks_leg_bending_alone():
    full, fast = (
        vt.simulate(vt.Scenario.load("position_sine", {**SHORT, "plant": p}))
        for p in ("ves2", "ves2_fast")
    )
    assert set(full.signals) - set(fast.signals) == {"truth.leg_bending"}
    assert fast.info.plant_base == "ves2_fast"


def test_both_fidelities_hear_the_same_noise():
    """White noise of the sensor is far above the difference of two standing rigs."""
    changes = {**SHORT, "platform.motion.amplitude": [0.0] * 6, "run.log": "tick"}
    full, fast = (
        vt.simulate(vt.Scenario.load("position_sine", {**changes, "plant": p}), seed=5)
        for p in ("ves2", "ves2_fast")
    )
    for name in ("arm.torque", "supply.pressure"):
        one, two = (np.diff(run[name][:, 0]) for run in (full, fast))
        assert np.corrcoef(one, two)[0, 1] > 0.99, name


def test_fast_repeats_from_a_snapshot_to_the_last_bit():
    changes = {"run.duration": 1.0, "plant": "ves2_fast"}
    sim = vt.Simulator(None, vt.Scenario.load("beam_horizontal_truth", changes), seed=1)
    sim.advance(0.5004)
    kept = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.restore(kept)
        sim.advance(0.3)
        ends.append((sim.data.qpos.copy(), sim.data.ten_length.copy(), sim.rig.board.row.copy()))
    for one, two in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, two)


def test_the_step_in_two_halves_is_mj_step():
    """Same state, same controls: mj_step2 then mj_step1 moves as mj_step does, to the last bit."""
    import mujoco

    changes = {**SHORT, "plant": "ves2_fast"}
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", changes))
    one, two = mujoco.MjData(sim.model), mujoco.MjData(sim.model)
    for data in (one, two):
        mujoco.mj_copyData(data, sim.model, sim.data)
        data.ctrl[:] += 50.0
    for _ in range(20):
        mujoco.mj_step(sim.model, one)
        mujoco.mj_step2(sim.model, two)
        mujoco.mj_step1(sim.model, two)
        np.testing.assert_array_equal(one.qpos, two.qpos)
        np.testing.assert_array_equal(one.sensordata, two.sensordata)


def test_fast_with_pressure_hydraulics_runs():
    changes = {**SHORT, "plant": "ves2_pressure_fast"}
    full, fast = (
        vt.simulate(vt.Scenario.load("position_sine", {**changes, "plant": p}))
        for p in ("ves2_pressure", "ves2_pressure_fast")
    )
    assert fast.info.outcome == "completed"
    # the settled poses differ by the sag of the legs' weight and the fade-in has begun
    np.testing.assert_allclose(fast["truth.pose"], full["truth.pose"], rtol=0, atol=1e-4)


def test_a_leg_beyond_its_stroke_ends_a_fast_run():
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", {**SHORT, "plant": "ves2_fast"}))
    assert sim.outcome is None
    sim.rig.parameters["limits"]["stroke"] = 1e-6
    sim.advance(0.5)
    assert sim.outcome == "leg_limit"


def test_a_fast_recording_is_drawn_with_the_legs_of_the_full_rig(tmp_path):
    run = vt.simulate(vt.Scenario.load("position_sine", {**SHORT, "plant": "ves2_fast"}))
    drawn = DrawnRig.of(run.info)
    assert drawn.note == ""
    assert {"leg1/cylinder", "leg6/rod"} <= set(drawn.bodies)
    assert write_rrd(run, tmp_path / "run.rrd").stat().st_size > 0
