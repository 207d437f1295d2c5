"""A draft finds what each column is, says by name what is wrong, and loads as a machine."""

from __future__ import annotations

import tomllib

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted, scales

from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.recordings.read import read_recording


def columns_of(rig):
    return {n: c.columns[0] for n, c in rig.description.signals.items()}


RIGHT = {
    **{f"{j}.position": f"q{i}" for i, j in enumerate(("turn", "lift", "bend"), 1)},
    **{f"m{i}.effort": f"tau{i}" for i in (1, 2, 3)},
}


def test_an_arm_in_order_is_matched_by_number_and_nothing_is_suspected(arm, columns, write):
    found, rig = drafted(arm, write(columns))
    assert columns_of(rig) == RIGHT
    assert set(scales(rig).values()) == {1.0}
    assert found.mode.startswith("motion")
    assert found.look == ("clock t: no unit is given, s is a guess",)
    assert found.left == {f"dq{i}": "is a speed" for i in (1, 2, 3)}
    assert min(found.explained.values()) > 0.9


def test_an_effort_of_which_much_is_left_out_is_told(arm, columns, write):
    """An isolator shaken up to 150 Hz was judged below 50 Hz, and nothing said so."""
    row = np.arange(len(columns["t"]))
    loud = columns["tau2"] + np.std(columns["tau2"]) * np.sin(0.8 * np.pi * row)
    found, _ = drafted(arm, write(changed(columns, tau2=loud)))
    assert found.mode.startswith("motion")
    assert "of the power of tau2 lies above" in found.mode


def test_a_draft_of_six_columns_is_short_and_reads_its_log(arm, columns, write):
    log = write(columns)
    found, rig = drafted(arm, log)
    assert len(found.text.splitlines()) < 40
    recording = read_recording(log, rig)
    assert recording["m2.effort"][:, 0] == pytest.approx(columns["tau2"], rel=1e-6)


def test_a_torque_of_the_wrong_sign_is_named_and_turned(arm, columns, write):
    found, rig = drafted(arm, write(changed(columns, tau2=-columns["tau2"])))
    assert any("tau2 has the wrong sign" in words for words in found.look)
    assert {n for n, scale in scales(rig).items() if scale < 0.0} == {"m2.effort"}


def test_a_position_that_counts_backwards_is_named_and_turned(arm, columns, write):
    found, rig = drafted(arm, write(changed(columns, q3=-columns["q3"], dq3=-columns["dq3"])))
    assert any("q3 counts against position of joint bend" in words for words in found.look)
    assert {n for n, scale in scales(rig).items() if scale < 0.0} == {"bend.position"}


def test_degrees_in_place_of_radians_are_named(arm, columns, write):
    degrees = {f"q{i}": np.degrees(columns[f"q{i}"]) for i in (1, 2, 3)}
    found, rig = drafted(arm, write(changed(columns, **degrees)))
    assert any("q1, q2, q3" in words and "deg" in words for words in found.look)
    assert scales(rig)["lift.position"] == pytest.approx(np.pi / 180.0)


@pytest.mark.parametrize(("one", "two"), [("tau1", "tau2"), ("tau2", "tau3"), ("q2", "q3")])
def test_swapped_columns_are_named_and_taken_the_other_way_round(arm, columns, write, one, two):
    log = write(changed(columns, **{one: columns[two], two: columns[one]}))
    found, rig = drafted(arm, log)
    assert any(f"{one} and {two} look swapped" in words for words in found.look)
    assert {n: c for n, c in columns_of(rig).items() if c in (one, two)} == {
        n: two if c == one else one for n, c in RIGHT.items() if c in (one, two)
    }


def test_kilonewtons_are_suspected_by_their_factor(arm, columns, write):
    found, _ = drafted(arm, write(changed(columns, tau2=columns["tau2"] / 1000.0)))
    assert any("tau2 is 0.001 times what the model needs" in words for words in found.look)


def test_an_electrical_command_gets_the_constant_that_fits_and_a_word_to_replace_it(
    arm, columns, write
):
    volts = {("u2_V" if n == "tau2" else n): v for n, v in columns.items()}
    volts["u2_V"] = volts["u2_V"] / 12.5
    found, rig = drafted(arm, write(volts))
    assert scales(rig)["m2.effort"] == pytest.approx(12.5, rel=0.05)
    assert any("u2_V is electrical" in words for words in found.look)
    assert rig.description.tolerances["gain"] == 0.2


@pytest.mark.parametrize(
    ("name", "factor", "other"),
    [("q1_deg", 1.0, "radians"), ("q1_deg", 57.2958, "")],
)
def test_an_angle_in_the_other_unit_is_asked_after_where_a_constant_would_hide_it(
    arm, columns, write, name, factor, other
):
    bare = {n: v for n, v in columns.items() if not n.startswith("dq")}  # speeds would tell it
    log = {{"q1": name, "tau1": "u1_V"}.get(n, n): v for n, v in bare.items()}
    log[name] = factor * log[name]
    found, _ = drafted(arm, write(log))
    asked = [words for words in found.look if words.startswith(name) and "if these are" in words]
    assert [f"if these are {other}" in words for words in asked] == [True] * bool(other)


def test_a_joint_whose_motor_has_no_column_has_its_motion_given(arm, columns, write):
    found, rig = drafted(arm, write({n: v for n, v in columns.items() if n != "tau3"}))
    assert found.mode == "motion: every joint has a position; what moves bend is not told"
    assert set(found.explained) == {"tau1", "tau2"}
    assert min(found.explained.values()) > 0.9
    assert not rig.description.drive.imposed


TABLE = """
<mujoco model="table"><option timestep="0.002" integrator="implicitfast"/><worldbody>
  <body name="slide"><joint name="x" type="slide" axis="1 0 0" damping="8" stiffness="60"/>
    <geom size="0.1" mass="3"/>
    <body name="head"><joint name="turn" axis="0 0 1" damping="0.5" stiffness="4"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="2"/></body></body>
  </worldbody><actuator><motor name="mx" joint="x"/><motor name="mt" joint="turn"/></actuator></mujoco>
"""


def test_a_joint_whose_motor_has_no_column_is_imposed_where_others_are_predicted(tmp_path):
    """Positions too noisy to be differentiated twice, and nothing tells what turns the head."""
    model, rng = mujoco.MjModel.from_xml_string(TABLE), np.random.default_rng(5)
    data, rows = mujoco.MjData(model), []
    for k in range(10_000):
        t = 0.002 * k
        data.ctrl[:] = 20.0 * np.sin(3.1 * t) + 9.0 * np.sin(7.3 * t), 2.0 * np.sin(2.3 * t)
        if k % 5 == 0:
            rows.append([t, *(data.qpos + 0.004 * rng.standard_normal(2)), data.ctrl[0]])
        mujoco.mj_step(model, data)
    (tmp_path / "table.xml").write_text(TABLE)
    log = tmp_path / "log.csv"
    np.savetxt(log, rows, "%.8g", ",", header="t,x_m,turn_rad,mx_N", comments="")
    found, rig = drafted(tmp_path / "table.xml", log)
    assert found.mode.startswith("control: x_m is too noisy")
    assert rig.description.drive.imposed == ("turn",)
    assert set(rig.description.start) == {"x"}
    assert found.explained["x.position"] > 0.8


def test_volts_of_a_model_that_takes_volts_stay_as_they_are(tmp_path, swing, write):
    """A gear that is not one says that the command is no effort; a constant would go in twice."""
    model = tmp_path / "volts.xml"
    model.write_text(swing[0].read_text().replace("<motor ", '<motor gear="0.04" '))
    volts = {("u_V" if n == "tau" else n): v for n, v in swing[1].items()}
    turned = (-25.0 * 1.1, -1.0)  # a gain of 10 % off stays for the diagnosis to find
    other = (25.0 * 12.0, pytest.approx(1.0 / 12.0, rel=0.1))
    for factor, told in ((25.0 * 1.02, 1.0), turned, other):
        scaled = volts | {"u_V": factor * volts["u_V"]}
        _, rig = drafted(model, write(scaled))
        assert scales(rig)["drive.effort"] == told
        assert rig.description.tolerances["gain"] == (0.2 if told == other[1] else 0.01)
        model.with_name("my.toml").unlink()


def test_an_arm_that_drifts_open_loop_has_its_motion_given_though_it_is_noisy(arm, columns, write):
    rng = np.random.default_rng(4)
    noisy = {f"q{i}": columns[f"q{i}"] + 0.003 * rng.standard_normal(1600) for i in (1, 2, 3)}
    found, rig = drafted(arm, write(changed(columns, **noisy)))
    assert found.mode.startswith("motion: open loop the model explains")
    # what is differentiated twice makes noise in the efforts, which the file counts
    quiet = drafted(arm, write(columns))[1].description.signals["m2.effort"].noise
    assert rig.description.signals["m2.effort"].noise > 3.0 * quiet


def test_positions_too_noisy_to_differentiate_are_predicted_where_a_model_can(swing, write):
    found, rig = drafted(swing[0], write(swing[1]))
    assert found.mode.startswith("control: q is too noisy")
    signals = rig.description.signals
    assert signals["joint.position"].noise == pytest.approx(0.003, rel=0.15)
    assert signals["joint.speed"].noise == pytest.approx(0.02, rel=0.15)
    assert rig.description.start["joint"].sd == pytest.approx(0.003, rel=0.15)
    assert min(found.explained.values()) > 0.9


def test_a_short_log_is_predicted_from_its_torque_where_a_model_can(swing, write):
    """Given as motion, its band leaves fewer rows than a diagnosis asks for."""
    model = mujoco.MjModel.from_xml_path(str(swing[0]))
    data, rows = mujoco.MjData(model), np.zeros((400, 3))
    for k in range(len(rows)):
        data.ctrl[0] = 0.5 * np.sin(0.06 * k)
        rows[k] = 0.01 * k, data.ctrl[0], data.qpos[0]
        mujoco.mj_step(model, data, 5)
    found, rig = drafted(swing[0], write(dict(zip(("t", "tau", "q"), rows.T, strict=True))))
    assert found.mode == "control: 4 s of motion leave 80 rows in the band of the efforts"
    assert rig.description.rate == 100.0


def test_a_short_log_of_a_machine_that_drifts_keeps_rows_enough(arm, columns, write):
    whole = drafted(arm, write(columns))[1]
    found, rig = drafted(arm, write({name: values[:400] for name, values in columns.items()}))
    assert found.mode.startswith("motion: open loop the model explains")
    assert 2.0 * whole.description.rate < 115.0 <= 2.05 * rig.description.rate


def test_stretches_that_are_held_out_have_rows_enough_for_a_diagnosis(arm, swing, columns, write):
    assert drafted(swing[0], write(swing[1]))[0].stretch == 2.0  # at 100 Hz
    slow, rig = drafted(arm, write(columns))
    assert (slow.stretch, rig.description.rate) == (0.0, 20.0)  # 8 s, where one takes 7.5
    twice = {name: np.concatenate([values, values]) for name, values in columns.items()}
    twice["t"] = 0.005 * np.arange(len(twice["t"]))
    longer, rig = drafted(arm, write(twice))
    assert 100.0 <= longer.stretch * rig.description.rate < 150.0  # three, where 150 leave two


def test_a_speed_that_counts_backwards_is_turned(swing, write):
    found, rig = drafted(swing[0], write(changed(swing[1], dq=-swing[1]["dq"])))
    assert scales(rig)["joint.speed"] == -1.0
    assert any("dq counts against q" in words for words in found.look)


def test_a_speed_in_degrees_is_told_by_its_position(swing, write):
    found, rig = drafted(swing[0], write(changed(swing[1], dq=np.degrees(swing[1]["dq"]))))
    assert scales(rig)["joint.speed"] == pytest.approx(np.pi / 180.0)
    assert any("as deg/s" in words for words in found.look)


def test_a_speed_that_follows_no_position_is_left_out(swing, write):
    rng = np.random.default_rng(1)
    found, rig = drafted(swing[0], write(changed(swing[1], dq=rng.standard_normal(1500))))
    assert "joint.speed" not in rig.description.signals
    assert any("dq does not follow q" in words for words in found.look)


def test_noise_is_told_from_rest_where_the_log_begins_at_rest(arm, columns, write):
    rng, still = np.random.default_rng(6), 400
    rested = {"t": 0.005 * np.arange(1600 + still)}
    for name, values in columns.items():
        if name != "t":
            scatter = 0.3 * rng.standard_normal(still) if name == "tau2" else 0.0
            rested[name] = np.concatenate([values[0] + scatter * np.ones(still), values])
    rested["q1"][:still] += 1e-6 * rng.standard_normal(still)
    found, rig = drafted(arm, write(rested))
    assert rig.description.signals["m2.effort"].noise == pytest.approx(0.3, rel=0.1)
    assert "scatter at rest" in found.text


def test_a_column_that_fits_nothing_is_listed_and_not_guessed(arm, columns, write):
    extra = {**columns, "temperature": 20.0 + columns["q1"], "flag": np.ones(1600)}
    found, _ = drafted(arm, write(extra))
    assert found.left["temperature"] == "nothing in the model has this name or unit"
    assert found.left["flag"] == "never changes"
    assert "# not used: temperature" in found.text


def test_a_command_beside_a_measured_torque_is_told_as_the_other_choice(arm, columns, write):
    both = {f"{n}_meas" if n.startswith("tau") else n: v for n, v in columns.items()}
    both |= {f"{n}_cmd": v for n, v in columns.items() if n.startswith("tau")}
    found, rig = drafted(arm, write(both))
    assert columns_of(rig)["m1.effort"] == "tau1_meas"
    (guess,) = (g for g in found.guesses if g.column == "tau1_meas")
    assert guess.others == "tau1_cmd would do as well"


def test_columns_numbered_from_zero_are_those_of_the_first_joint_on(arm, columns, write):
    zero = {n[:-1] + str(int(n[-1]) - 1) if n != "t" else n: v for n, v in columns.items()}
    _, rig = drafted(arm, write(zero))
    assert columns_of(rig)["turn.position"] == "q0"
    assert columns_of(rig)["m3.effort"] == "tau2"


def test_rows_with_empty_cells_at_the_end_are_left_out_by_a_window(arm, columns, write):
    log = write(columns)
    log.write_text(log.read_text() + "".join(f"{8 + k / 200},,,,,,,,,\n" for k in range(9)))
    found, rig = drafted(arm, log)
    assert tomllib.loads(found.text)["window"]["stop"] == pytest.approx(7.9975)
    assert len(read_recording(log, rig)) == 1600


def test_an_empty_cell_here_and_there_leaves_the_log_whole(arm, columns, write):
    log = write(columns)
    lines = log.read_text().splitlines()
    for k in (100, 901):
        lines[k] = ",".join([lines[k].partition(",")[0], *[""] * (len(columns) - 1)])
    log.write_text("\n".join(lines) + "\n")
    found, rig = drafted(arm, log)
    assert "window" not in tomllib.loads(found.text)
    assert any("2 rows lack a number" in words for words in found.look)
    assert len(read_recording(log, rig)) == 1600


def test_a_log_in_milliseconds_and_semicolons_needs_no_hand(arm, columns, write):
    log = write({**columns, "t": 1000.0 * columns["t"]})
    log.write_text(log.read_text().replace(",", ";").replace("t;", "Time (ms);", 1))
    _, rig = drafted(arm, log)
    assert rig.description.clock.scale == 0.001
    assert read_recording(log, rig).time[-1] == pytest.approx(7.995)


def test_the_largest_table_of_a_file_of_arrays_is_taken_by_its_full_names(arm, columns, tmp_path):
    slow = {"temp": np.arange(50.0), "clock": np.arange(50.0)}
    np.savez(tmp_path / "log.npz", **columns, **slow)
    _, rig = drafted(arm, tmp_path / "log.npz")
    recording = read_recording(tmp_path / "log.npz", rig)
    assert recording["turn.position"][:, 0] == pytest.approx(columns["q1"], abs=1e-12)


def test_where_no_name_tells_the_effort_is_the_one_that_the_other_s_motion_needs(tmp_path):
    model = tmp_path / "mass.xml"
    model.write_text(
        '<mujoco model="mass"><option gravity="0 0 0"/><worldbody><body name="b"><joint name="y"'
        ' type="slide" damping="0.5" stiffness="40"/><geom size="0.1" mass="1"/></body></worldbody>'
        '<actuator><motor name="u" joint="y"/></actuator></mujoco>'
    )
    time = 0.01 * np.arange(2000)
    y = 0.02 * np.sin(5.0 * time) + 0.01 * np.sin(1.7 * time) + 0.01 * np.sin(9.1 * time + 1.0)
    speed = np.gradient(y, 0.01)
    effort = np.gradient(speed, 0.01) + 0.5 * speed + 40.0 * y
    for columns, wanted in (((effort, y), ("V2", "V1")), ((y, effort), ("V1", "V2"))):
        rows = np.column_stack(columns)
        np.savetxt(tmp_path / "log.csv", rows, "%.8g", ",", header="V1,V2", comments="")
        found = draft(model, [tmp_path / "log.csv"], tmp_path / "m.toml", 100.0)
        signals = tomllib.loads(found.text)["signals"]
        assert (*signals["y.position"]["columns"], *signals["u.effort"]["columns"]) == wanted


def test_a_torque_is_taken_before_the_voltage_of_a_supply(swing, write):
    model, columns = swing
    rows = len(columns["t"])
    supply = {"t": columns["t"], "c1 voltage [V]": 36.0 + 0.5 * (np.arange(rows) % 3)}
    supply |= {f"{n} [{u}]": columns[n] for n, u in (("tau", "Nm"), ("q", "rad"))}
    _, rig = drafted(model, write(supply))
    assert columns_of(rig)["drive.effort"] == "tau [Nm]"


def test_rows_that_come_unevenly_are_no_thousand_gaps(swing, write):
    model, columns = swing
    places = np.arange(len(columns["t"]))
    kept = places[(places % 7 != 3) & (places % 7 != 4)]  # steps of 10 and 30 ms
    found, _ = drafted(model, write({n: v[kept] for n, v in columns.items()}))
    assert "clock t: uneven, steps of 0.01 to 0.03 s; rows are read at even steps" in found.look
    assert not any("gaps" in words for words in found.look)


def test_typical_efforts_are_those_of_the_joints_behind_their_gears(arm, tmp_path, columns, write):
    """Of motors that turn fifty times as fast: what is typical of a joint does not change."""
    found = []
    for gear in (1.0, 50.0):
        geared = tmp_path / f"arm{gear:g}.xml"
        geared.write_text(arm.read_text().replace("<motor ", f'<motor gear="{gear}" '))
        shaft = {n: v / gear if n.startswith("tau") else v for n, v in columns.items()}
        _, rig = drafted(geared, write(shaft))
        found.append({j: span.effort for j, span in rig.description.typical.joint.items()})
    assert set(found[0]) == {"turn", "lift", "bend"}
    assert found[1] == pytest.approx(found[0], rel=0.02)


HOIST = """
<mujoco model="hoist"><worldbody><body name="load">
  <joint name="z" type="slide" axis="0 0 1" range="-0.3 0.3" limited="true" damping="20"/>
  <geom size="0.1" mass="5"/></body></worldbody>
  <actuator><motor name="lift" joint="z"/></actuator></mujoco>
"""


def hoisted(folder, **changes):
    """A load that is lifted and lowered, 0.3 A for each newton, and what a draft says of its log."""
    (folder / "hoist.xml").write_text(HOIST)
    time = 0.01 * np.arange(2000)
    z = 0.1 * np.sin(2.0 * time) + 0.04 * np.sin(5.3 * time + 1.0) + 0.02 * np.sin(9.1 * time)
    v, a = np.gradient(z, 0.01), np.gradient(np.gradient(z, 0.01), 0.01)
    columns = {
        "t": time,
        "z": z,
        "i_A": 0.3 * (5.0 * (a + 9.81) + 20.0 * v + 2.0 * np.tanh(v / 0.01)),
    }
    for name, factor in changes.items():
        columns[name] = factor * columns[name]
    head, rows = ",".join(columns), np.column_stack(list(columns.values()))
    np.savetxt(folder / "log.csv", rows, "%.8g", ",", header=head, comments="")
    return drafted(folder / "hoist.xml", folder / "log.csv")


@pytest.mark.parametrize("current", [1.0, -1.0])
@pytest.mark.parametrize("position", [1.0, -1.0])
def test_a_weight_tells_whether_the_position_or_the_current_counts_backwards(
    tmp_path, position, current
):
    """Turning the other of them explains the motion as well, and lets the weight push up."""
    found, rig = hoisted(tmp_path, z=position, i_A=current)
    turned = {name: np.sign(scale) for name, scale in scales(rig).items()}
    assert turned == {"z.position": position, "lift.effort": current}
    said = [words for words in found.look if "turned" in words]
    assert len(said) == (position < 0.0) + (current < 0.0)


def test_a_position_far_beyond_its_joint_s_range_is_told(tmp_path):
    found, _ = hoisted(tmp_path, z=1000.0)
    assert any("joint z from -0.3 to 0.3: another unit" in words for words in found.look)
    found, _ = hoisted(tmp_path)
    assert not any("another unit" in words for words in found.look)
