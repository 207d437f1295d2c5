"""Tests of a recording as a rerun file: it is read back and compared with the recording."""

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from rerun.chunk import RrdReader

import ves_twin
from ves_twin import Plant, Recording, Scenario
from ves_twin.core import whole_file
from ves_twin.core.errors import FileAccessError, one_line
from ves_twin.core.recording.recording import Event
from ves_twin.core.signals import SIGNALS, Role, Signal
from ves_twin.plant.assembly import assemble
from ves_twin.plant.layout import Layout
from ves_twin.plant.statics import place_rig
from ves_twin.report.rerun import write
from ves_twin.report.rerun.account import account
from ves_twin.report.rerun.blueprint import blueprint_of
from ves_twin.report.rerun.series import series_of
from ves_twin.report.rerun.write import write_rrd


def _run(name: str, duration: float) -> Recording:
    return ves_twin.simulate(Scenario.load(name, {"run.duration": duration}))


@pytest.fixture(scope="module")
def sine() -> Recording:
    return _run("position_sine", 0.5)


@pytest.fixture(scope="module")
def beam() -> Recording:
    return _run("beam_horizontal_truth", 1.0)


@pytest.fixture(scope="module")
def beam_file(beam, tmp_path_factory) -> Path:
    return write_rrd(beam, tmp_path_factory.mktemp("rrd") / "beam.rrd")


def _column(path: Path, entity: str, component: str) -> np.ndarray:
    """All rows of a component that varies over time (n, width), in the order of the file."""
    found = []
    for chunk in RrdReader(path).stream():
        if chunk.entity_path == f"/{entity}" and not chunk.is_static:
            found += chunk.to_record_batch().column(component).to_pylist()
    return np.array(found, dtype=float).reshape(len(found), -1)


def _texts(path: Path, entity: str, component: str) -> list[str]:
    return [
        value[0]
        for chunk in RrdReader(path).stream()
        if chunk.entity_path == f"/{entity}"
        for value in chunk.to_record_batch().column(component).to_pylist()
    ]


def _entities(path: Path) -> set[str]:
    return {chunk.entity_path for chunk in RrdReader(path).stream()}


def _leaves(entities: set[str], root: str) -> set[str]:
    return {e for e in entities if e.startswith(f"/{root}/")}


def test_every_signal_of_a_recording_appears_with_every_row(beam, beam_file):
    for name in beam.signals:
        entities = {
            e
            for e in _entities(beam_file)
            if e == f"/signals/{name}" or e.startswith(f"/signals/{name}/")
        }
        values = [_column(beam_file, e[1:], "Scalars:scalars") for e in entities]
        assert sum(v.shape[1] for v in values) == SIGNALS[name].width, name
        assert all(len(v) == len(beam) for v in values), name


def test_a_length_is_plotted_in_millimetres_and_a_force_in_newtons(beam, beam_file):
    lengths = _column(beam_file, "signals/leg.length", "Scalars:scalars")
    np.testing.assert_allclose(lengths, 1e3 * beam["leg.length"], rtol=1e-12)
    force = _column(beam_file, "signals/sensor.wrench/force", "Scalars:scalars")
    np.testing.assert_allclose(force, beam["sensor.wrench"][:, :3], rtol=1e-12)


def test_the_dynamic_wrench_is_the_sensor_less_the_gravity_estimate(beam, beam_file):
    expected = beam["sensor.wrench"] - beam["gravity.estimate"]
    for part, columns in (("force", slice(0, 3)), ("moment", slice(3, 6))):
        shown = _column(beam_file, f"dynamic_wrench/{part}", "Scalars:scalars")
        np.testing.assert_allclose(shown, expected[:, columns], atol=1e-12)


def test_base_motion_stands_beside_the_reference_on_each_axis(beam, beam_file):
    shown = _column(beam_file, "base_motion/y", "Scalars:scalars")
    expected = 1e3 * np.column_stack([beam["truth.pose"][:, 1], beam["reference.pose"][:, 1]])
    np.testing.assert_allclose(shown, expected, atol=1e-12)
    error = _column(beam_file, "base_motion/error/angles", "Scalars:scalars")
    difference = beam["truth.pose"] - beam["reference.pose"]
    np.testing.assert_allclose(error, 1e3 * difference[:, 3:], atol=1e-12)


def test_series_are_named_with_their_unit(beam_file):
    names = [
        chunk.to_record_batch().column("SeriesLines:names").to_pylist()[0]
        for chunk in RrdReader(beam_file).stream()
        if chunk.entity_path == "/signals/leg.command" and chunk.is_static
    ]
    assert names == [[f"leg {i} [mm]" for i in range(1, 7)]]


@pytest.mark.parametrize(
    ("root", "pose", "arm"),
    [("machine", "truth.pose", "truth.arm_q"), ("ghost", "reference.pose", "arm.command")],
)
def test_the_transforms_of_the_bodies_agree_with_mujoco(beam, beam_file, root, pose, arm):
    plant = Plant.load("ves2")
    model = assemble(plant, 1e-3).compile()
    data = mujoco.MjData(model)
    frame = 17
    row = int(_column(beam_file, f"{root}/arm/link3", "row")[frame, 0])
    place_rig(data, Layout.of(model), plant.geometry, beam[pose][row], beam[arm][row])
    mujoco.mj_kinematics(model, data)
    for name in ("platform/top", "arm/link3"):
        position = _column(beam_file, f"{root}/{name}", "Transform3D:translation")[frame]
        turn = _column(beam_file, f"{root}/{name}", "Transform3D:quaternion")[frame]
        body = data.body(name)
        np.testing.assert_allclose(position, body.xpos, atol=1e-6)
        np.testing.assert_allclose(turn, body.xquat[[1, 2, 3, 0]], atol=1e-6)


def test_the_drawn_platform_is_where_the_true_pose_says(beam, beam_file):
    rows = _column(beam_file, "machine/platform/top", "row")[:, 0].astype(int)
    position = _column(beam_file, "machine/platform/top", "Transform3D:translation")
    expected = Plant.load("ves2").geometry.home + beam["truth.pose"][rows, :3]
    np.testing.assert_allclose(position, expected, atol=1e-6)
    assert 25 <= len(rows) <= 35
    assert rows[0] == 0
    assert rows[-1] == len(beam) - 1


def test_every_geom_is_drawn_once(beam_file):
    model = assemble(Plant.load("ves2"), 1e-3).compile()
    expected = {
        f"/machine/{model.body(body).name}/{model.geom(i).name.rsplit('/', 1)[-1]}"
        for i, body in enumerate(model.geom_bodyid)
    }
    bodies = {f"/machine/{model.body(i).name}" for i in range(1, model.nbody)}
    assert len(expected) == model.ngeom
    assert _leaves(_entities(beam_file), "machine") == expected | bodies


def test_the_ghost_has_a_platform_and_an_arm_but_no_legs(beam_file):
    ghost = _leaves(_entities(beam_file), "ghost")
    assert "/ghost/platform/top/plate" in ghost
    assert "/ghost/arm/link3/forearm" in ghost
    assert not any("leg" in entity for entity in ghost)


def test_without_a_reference_there_is_no_ghost_and_no_emulation_error(sine, tmp_path):
    entities = _entities(write_rrd(sine, tmp_path / "sine.rrd"))
    assert "reference.pose" not in sine.signals
    assert not _leaves(entities, "ghost")
    assert not any(e.startswith("/base_motion/error") for e in entities)
    assert "/base_motion/x" in entities


def test_the_layout_travels_in_the_file(beam_file):
    reader = RrdReader(beam_file)
    (recording,) = reader.recordings()
    (blueprint,) = reader.blueprints()
    assert blueprint.application_id == recording.application_id


def test_only_simulated_time_and_row_are_timelines(beam_file):
    timelines = {name for chunk in RrdReader(beam_file).stream() for name in chunk.timeline_names}
    assert timelines == {"sim_time", "row"}


def test_events_carry_a_level_and_failures_are_errors(beam, tmp_path):
    events = (Event(0.2, "note", "looked"), Event(0.9, "leg_limit", "leg 3"))
    info = replace(beam.info, events=events, outcome="leg_limit")
    path = write_rrd(replace(beam, info=info), tmp_path / "a.rrd")
    assert _texts(path, "events", "TextLog:text") == ["note: looked", "leg_limit: leg 3"]
    assert _texts(path, "events", "TextLog:level") == ["INFO", "ERROR"]


def test_the_account_tells_question_plant_outcome_and_emulation_error(beam, beam_file):
    (text,) = _texts(beam_file, "account", "TextDocument:text")
    for part in ("How truly", beam.info.plant_hash, "seed 0", "completed", "| y [mm] |", "mujoco"):
        assert part in text


def test_the_account_counts_motion_from_the_scenarios_home_as_the_summary_does(beam):
    settings = json.loads(beam.info.settings)
    home = [0.0, 0.0, -0.2, 0.0, 0.0, 0.0]
    settings["platform"]["home"] = home
    poses = ("truth.pose", "reference.pose", "reference.pose_leg_lag")
    there = {name: beam[name] + home for name in poses}
    moved = replace(beam, signals=there, info=replace(beam.info, settings=json.dumps(settings)))
    # the same motion about another home: the same table, but for round-off of the sum
    assert _table_of(account(moved)) == _table_of(account(beam))
    settings["platform"]["home"] = "harmed"
    assert account(replace(moved, info=replace(beam.info, settings=json.dumps(settings))))


def _table_of(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("|")]


def test_long_recordings_are_sent_in_chunks(beam, tmp_path, monkeypatch):
    monkeypatch.setattr(write, "ROWS_PER_CHUNK", 30)
    path = write_rrd(beam, tmp_path / "a.rrd")
    lengths = _column(path, "signals/leg.length", "Scalars:scalars")
    np.testing.assert_allclose(lengths, 1e3 * beam["leg.length"], rtol=1e-12)


def test_a_recording_of_one_measured_signal_can_be_written(beam, tmp_path):
    info = replace(beam.info, origin="measured", settings="{}", plant="", plant_hash="", events=())
    few = Recording(beam.time, {"leg.length": beam["leg.length"]}, info)
    assert "/signals/leg.length" in _entities(write_rrd(few, tmp_path / "a.rrd"))


@pytest.fixture
def own(beam) -> Recording:
    """A recording with a signal of its own in two units that no signal of the rig has."""
    units = ("m/s", "m/s", "rad/s^2")
    signal = Signal("hand.rates", ("x", "y", "turn"), units, Role.MEASUREMENT, "i", "of a hand")
    values = np.random.default_rng(2).normal(size=(len(beam), 3))
    info = replace(beam.info, own_signals=(signal,))
    return Recording(beam.time, {**beam.signals, signal.name: values}, info)


def test_a_signal_of_ones_own_in_other_units_is_written(own, tmp_path):
    path = write_rrd(own, tmp_path / "a.rrd")
    speeds = _column(path, "signals/hand.rates/m_per_s", "Scalars:scalars")
    np.testing.assert_allclose(speeds, own["hand.rates"][:, :2])
    turns = _column(path, "signals/hand.rates/rad_per_s_2", "Scalars:scalars")
    np.testing.assert_allclose(turns, own["hand.rates"][:, 2:])


def test_signals_of_ones_own_have_a_page_and_those_of_the_rig_need_none(own, beam):
    entities = frozenset(s.entity for s in series_of(own))
    (page,) = (p for p in _pages(entities) if p.name == "Other signals")
    shown = {content for view in page.contents for content in view.contents}
    assert shown == {"/signals/hand.rates/m_per_s", "/signals/hand.rates/rad_per_s_2"}
    usual = frozenset(s.entity for s in series_of(beam))
    assert "Other signals" not in {p.name for p in _pages(usual)}


def _pages(entities: frozenset[str]) -> list:
    upper, _ = blueprint_of(entities).root_container.contents
    return list(upper.contents[1].contents)


def test_an_empty_recording_can_be_written(beam, tmp_path):
    path = write_rrd(beam.window(-2.0, -1.0), tmp_path / "a.rrd")
    assert "/account" in _entities(path)


def test_rows_that_are_not_finite_are_not_drawn(beam, tmp_path):
    broken = beam["truth.pose"].copy()
    broken[len(beam) // 2 :] = np.nan
    recording = replace(beam, signals={**beam.signals, "truth.pose": broken})
    path = write_rrd(recording, tmp_path / "a.rrd")
    rows = _column(path, "machine/platform/top", "row")
    assert rows.max() < len(beam) // 2
    assert "not finite" in _texts(path, "account", "TextDocument:text")[0]


def test_a_plant_that_is_gone_is_replaced_and_said_so(beam, tmp_path):
    info = replace(beam.info, plant_base="no_such_plant")
    path = write_rrd(replace(beam, info=info), tmp_path / "a.rrd")
    (text,) = _texts(path, "account", "TextDocument:text")
    assert "The drawing shows ves2: unknown plant 'no_such_plant'" in text


def test_a_read_only_target_gives_one_line(beam, tmp_path, monkeypatch):
    target = tmp_path / "kept.rrd"
    target.write_text("kept")
    monkeypatch.setattr(whole_file.os, "access", lambda *_: False)  # also where root may write
    with pytest.raises(FileAccessError, match="read-only") as caught:
        write_rrd(beam, target)
    assert "\n" not in str(caught.value)
    assert target.read_text() == "kept"


@pytest.mark.parametrize("where", ["missing/a.rrd", "file/a.rrd", "folder"])
def test_a_target_that_cannot_be_made_gives_one_line(beam, tmp_path, where):
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    with pytest.raises(FileAccessError, match="cannot write") as caught:
        write_rrd(beam, tmp_path / where)
    assert one_line(caught.value) == str(caught.value)
    assert not list(tmp_path.rglob("*.partial"))


def test_a_disk_that_fills_up_leaves_no_file_behind(beam, tmp_path, monkeypatch):
    def full(_: object, content: bytes) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(FileAccessError, match="cannot write"):
        write_rrd(beam, tmp_path / "a.rrd")
    assert not list(tmp_path.iterdir())
