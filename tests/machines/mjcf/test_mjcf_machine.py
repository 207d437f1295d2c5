"""An MJCF machine has what VES II has: the whole comparison, excitations, a plan; one protocol."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import slide
from two_link import TARGETS, TIME, programme, write_files

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.residuals.noise import NoiseSource
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.machine import SETPOINTS, Machine, Material, Named
from ves_twin.machines.mjcf.inputs.excitations import BANDS, offered, write_inputs
from ves_twin.machines.mjcf.inputs.inputs import BORNE
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.tolerance import Tolerance
from ves_twin.report.comparison.page import comparison_page

NOISE = 1e-4
"""Of positions and angles in the recordings of these tests [m, rad]."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return Machine.load(str(write_files(tmp_path_factory.mktemp("machine"))))


UNITS = {"rail": "m", "swing": "rad"}


def recorded(machine, seed, values=None, scale=1.0, mode=None):
    """A motion of the machine, with noise on what is measured."""
    forward = MjcfForward.of(machine.rig, mode)
    drive = {name: scale * rows for name, rows in programme().drive.items()}
    rows = forward.simulate(Excitation("x", TIME, drive), values or {})
    rng, signals = np.random.default_rng(seed), {n: drive[n] for n in forward.fed}
    for c, channel in enumerate(forward.channels):
        if machine.rig.description.compare[channel.signal].joint:
            noise = NOISE * rng.normal(size=len(TIME))
            signals[channel.signal] = rows[:, [c]] + noise[:, None]
    return Recording(TIME, signals, RecordingInfo("measured", scenario=f"run{seed}"))


def still(seed):
    rows = NOISE * np.random.default_rng(seed).normal(size=(len(TIME), 2))
    signals = {"cart.position": rows[:, :1], "arm.angle": rows[:, 1:]}
    return Recording(TIME, signals, RecordingInfo("measured"))


def test_the_machine_that_made_a_record_leaves_noise_and_another_one_does_not(machine):
    (found,) = vt.compare([recorded(machine, 1)], machine, standstill=still(9)).recordings
    assert {c.name for c in found.channels} == {"cart.position", "arm.angle"}
    for channel in found.channels:
        assert channel.noise is NoiseSource.STANDSTILL
        assert channel.rms_sigma == pytest.approx(1.0, abs=0.1)
        assert channel.bands
        assert channel.blocks
    assert found.beyond_noise == ()
    heavy = recorded(machine, 1, {"coulomb_friction@rail:level": 2.0})
    (found,) = vt.compare([heavy], machine, standstill=still(9)).recordings
    assert "cart.position" in [c.name for c in found.beyond_noise]
    assert all(c.coherence is not None for c in found.channels)
    page = comparison_page(vt.compare([heavy], machine, standstill=still(9)))
    assert "efforts fed in as recorded" in page
    assert "rms below 50 Hz" in page


def test_a_column_whose_noise_nobody_tells_is_compared_and_never_beyond_noise(machine):
    told = machine.rig.description
    column = told.signals["cart.position"].model_copy(update={"noise": 0.0})
    bare = told.model_copy(update={"signals": {**told.signals, "cart.position": column}})
    silent = type(machine)(type(machine.rig)(bare, machine.rig.folder))
    result = vt.compare([recorded(machine, 1, {"coulomb_friction@rail:level": 2.0})], silent)
    (found,) = result.recordings
    (cart,) = (c for c in found.channels if c.name == "cart.position")
    assert cart.noise is NoiseSource.NOBODY
    assert cart.rms > 10.0 * NOISE
    assert not cart.beyond_noise
    content = result.to_dict()["recordings"][0]["channels"]["cart.position"]
    assert content["rms_sigma"] is None
    assert "cart.position" in comparison_page(result)


def test_against_holds_two_days_of_one_programme_directly_and_of_two_by_their_residuals(machine):
    today, before = recorded(machine, 1), recorded(machine, 2)
    options = {"standstill": still(9)}
    (found,) = vt.compare([today], machine, against=before, **options).recordings
    assert found.basis == "recording"
    assert found.beyond_noise == ()
    other = recorded(machine, 3, scale=0.6)
    (found,) = vt.compare([today], machine, against=other, **options).recordings
    assert found.basis == "residual"
    assert found.beyond_noise == ()
    sticky = recorded(machine, 4, {"coulomb_friction@rail:level": 2.0})
    (found,) = vt.compare([sticky], machine, against=other, **options).recordings
    assert "cart.position" in [c.name for c in found.beyond_noise]


def test_limits_are_of_the_machine_s_own_signals_and_hold_over_its_modes(machine, tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text('schema = 1\n[rms]\n"cart.positon" = "1 mm"\n')
    with pytest.raises(UnknownNameError, match=r"did you mean 'cart\.position'"):
        Tolerance.load(path, machine.signals)
    path.write_text('schema = 1\n[rms]\n"cart.position" = "0.3 mm"\n"load.force" = "1 N"\n')
    limits = Tolerance.load(path, machine.signals)
    kept = vt.compare([recorded(machine, 1)], machine, tolerance=limits)
    # a signal that was not recorded keeps none
    assert [e.channel for e in kept.excesses] == [f"load.force.{i}" for i in (1, 2, 3)]
    assert all(e.found is None for e in kept.excesses)
    moved = recorded(machine, 1, {"coulomb_friction@rail:level": 2.0})
    broken = vt.compare([moved], machine, tolerance=limits)
    assert any(e.channel == "cart.position" and e.found for e in broken.excesses)


@pytest.mark.parametrize("mode", [Mode.CONTROL, Mode.REFERENCE, Mode.MOTION])
def test_what_is_offered_keeps_typical_travel_and_speed_and_reads_back(machine, tmp_path, mode):
    forward = MjcfForward.of(machine.rig, mode)
    menu = offered(forward)
    assert len({one.name for one in menu}) == len(menu) > 0
    typical = machine.rig.description.typical.joint
    names = [channel.name for channel in forward.channels]
    for one in menu:
        rows = forward.simulate(one, {})
        assert np.isfinite(rows).all()
        for joint, span in typical.items():
            signal = forward.position_of(joint)
            path = one.drive[signal][:, 0] if mode is Mode.MOTION else rows[:, names.index(signal)]
            assert np.max(np.abs(path - path[0])) <= BORNE * to_si(span.travel, UNITS[joint], joint)
            assert np.max(np.abs(np.gradient(path, one.time))) <= BORNE * to_si(
                span.speed, f"{UNITS[joint]}/s", joint
            )
    write_inputs(forward, menu[0], tmp_path)
    told = machine.rig.description
    head, *lines = Path(tmp_path, SETPOINTS).read_text().splitlines()
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    for name in forward.fed:
        column = told.signals[name]
        raw = table[:, head.split(",").index(column.columns[0])]
        # twelve digits
        assert column.scale * raw + column.offset == pytest.approx(
            menu[0].drive[name][:, 0], abs=1e-9
        )


def test_a_plan_of_an_mjcf_machine_says_what_an_excitation_could_find(tmp_path):
    machine, settings = Machine.load(str(slide.write_files(tmp_path))), Settings(nulls=20)
    plan = vt.plan(machine, "multisine", quick=True, settings=settings)
    assert plan.programme == "multisine"
    assert {p.effect for p in plan.prospects if p.smallest is not None} >= {"coulomb_friction"}
    with pytest.raises(UnknownNameError, match="did you mean 'multisine'"):
        vt.plan(machine, "multisin", quick=True)


def test_an_excitation_takes_the_clock_of_the_recording_that_it_follows(machine):
    for one in machine.excitations(recorded(machine, 1)):
        assert one.period == pytest.approx(TIME[1] - TIME[0])


@pytest.mark.slow
def test_causes_that_cannot_be_told_apart_get_a_next_experiment_in_the_log_s_own_columns(
    tmp_path, capsys
):
    """A gain of 0.97 against 3 % more mass."""
    path = slide.write_files(tmp_path)
    weak = {"mass": 5.0, "damping": 10.0, "gain": 0.97}
    slide.write_day(tmp_path / "log.csv", np.random.default_rng(5), weak, 0.0)
    words = ["diagnose", str(tmp_path / "log.csv"), "--plant", str(path), "--json"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["verdict"] == "ambiguous"
    assert {p["programme"] for p in said["next_experiment"]} <= set(BANDS)
    assert (tmp_path / "out" / "diagnosis.rrd").stat().st_size > 1000
    head, *rows = (tmp_path / "out" / SETPOINTS).read_text().splitlines()
    assert head == "t,f"
    assert max(abs(float(row.split(",")[1])) for row in rows) <= 15.0  # typical effort


def test_nothing_is_offered_where_an_actuator_drives_no_joint(tmp_path):
    """Its numbers of typical effort and travel are those of joints."""
    kinds = {kind: on for kind, on in TARGETS.items() if kind != "drive_cross_talk"}  # of joints
    path = write_files(tmp_path, kinds=kinds)
    model = tmp_path / "two_link.xml"
    text = model.read_text().replace(
        '<motor name="hinge" joint="swing"/>', '<motor name="hinge" tendon="rope"/>'
    )
    rope = '<tendon><fixed name="rope"><joint joint="swing" coef="1"/></fixed></tendon><actuator>'
    model.write_text(text.replace("<actuator>", rope))
    forward = MjcfForward.of(Machine.load(str(path)).rig)
    assert forward.joint_of("hinge") == ""
    assert offered(forward) == ()


@pytest.mark.parametrize("name", ["ves2_fast", "emps", "ft_wrist"])
def test_every_machine_has_the_protocol(name):
    machine = Machine.load(name)
    assert machine.name == name
    assert machine.identity == Machine.load(name).identity
    assert machine.signals
    for signal_name, signal in machine.signals.items():
        assert signal.name == signal_name
        assert len(signal.columns) == len(signal.units) == signal.width
    for signal_name, (low, high) in machine.ranges.items():
        assert np.all(low < high), signal_name


def test_an_experiment_of_another_kind_of_machine_is_refused(machine):
    from ves_twin.scenario.experiment import Experiment

    with pytest.raises(InvalidInputError, match="one with an MJCF machine"):
        machine.prepare(Material((Named("a", recorded(machine, 1)),)), Experiment())


def test_compare_writes_page_and_exit_code_for_an_mjcf_machine(tmp_path, capsys):
    path = write_files(tmp_path)
    machine = Machine.load(str(path))
    told = machine.rig.description
    one = recorded(machine, 1)
    columns = {told.clock.column: one.time / told.clock.scale}
    for name, column in told.signals.items():
        rows = one.signals.get(name, np.zeros((len(TIME), len(column.columns))))
        raw = (rows - column.offset) / column.scale
        columns |= dict(zip(column.columns, raw.T, strict=True))
    lines = [
        ",".join(columns),
        *(",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)),
    ]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    limits = tmp_path / "limits.toml"
    limits.write_text('schema = 1\n[rms]\n"cart.position" = "1 um"\n')
    words = ["compare", str(tmp_path / "log.csv"), "--plant", str(path), "--json"]
    words += ["--tolerance", str(limits), "--out", str(tmp_path / "out")]
    assert main(words) == 4
    said = json.loads(capsys.readouterr().out)
    assert said["out_of_tolerance"][0]["channel"] == "cart.position"
    assert {r["mode"] for r in said["recordings"]} == {"control", "reference"}
    assert (tmp_path / "out" / "report.html").stat().st_size > 1000
