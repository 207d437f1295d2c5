"""import: columns become signals in SI, on one clock, with an account; bad maps get one line."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.writer import Writer

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.mapping.import_map import ImportMap, Window
from ves_twin.plant.plant import Plant
from ves_twin.plant.signal_ranges import signal_ranges

T = np.arange(400) * 0.01


@pytest.fixture
def lab(tmp_path):
    """Write columns as CSV, import them by a map; returns what was imported."""

    def bring(columns, told, window=None, plausible=None):
        path, map_path = tmp_path / "lab.csv", tmp_path / "lab.toml"
        rows = np.column_stack(list(columns.values()))
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows.tolist())]
        path.write_text("\n".join(lines).replace("nan", "") + "\n")
        map_path.write_text("schema = 1\n" + told)
        return import_log(open_log(path), ImportMap.load(map_path), window, plausible)

    return bring


CLOCK = '[clock]\ncolumn = "t [s]"\n'


def channel(source, target, more=""):
    return f'[[channel]]\nfrom = "{source}"\nto = "{target}"\n{more}\n'


def test_unit_scale_offset_and_sign_act_in_that_order(lab):
    told = CLOCK + channel("raw", "arm.q.2", 'unit = "deg"\nscale = 0.5\noffset = 10.0\nsign = -1')
    found = lab({"t [s]": T, "raw": 4.0 * T}, told)
    wanted = -np.radians(0.5 * 4.0 * T + 10.0)
    # a few roundings of doubles
    assert np.allclose(found.recording["arm.q"][:, 1], wanted, rtol=1e-15, atol=1e-15)
    assert np.isnan(found.recording["arm.q"][:, 0]).all()
    assert "times 0.5, +10, deg converted to rad, sign turned" in found.account.to_text()


def test_a_signal_of_ones_own_keeps_its_unit_through_a_file(lab, tmp_path):
    told = CLOCK + channel("i [mA]", "motor.current.1") + channel("j [mA]", "motor.current.2")
    told += '[signals."motor.current"]\nunit = "A"\nrole = "measurement"\nframe = "motor"\n'
    recording = lab({"t [s]": T, "i [mA]": 100.0 + T, "j [mA]": T}, told).recording
    save_recording(recording, tmp_path / "r.parquet")
    loaded = load_recording(tmp_path / "r.parquet")
    assert loaded["motor.current"][0, 0] == pytest.approx(0.1)
    signal = loaded.info.signal("motor.current")
    assert (signal.units, signal.role, signal.frame) == (("A", "A"), Role.MEASUREMENT, "motor")
    assert loaded.info == recording.info or loaded.info.own_signals == recording.info.own_signals
    assert json.dumps(loaded.info.to_dict())


def test_what_was_done_travels_with_the_recording(lab):
    imported = lab(
        {"t [s]": T + 5.0, "p [bar]": 100.0 + T}, CLOCK + channel("p [bar]", "supply.pressure")
    )
    info = imported.recording.info
    assert info.origin == "measured"
    assert info.imported["zero"] == 5.0
    assert len(info.imported["sha256"]) == 64
    assert info.imported["map"]["channel"][0]["to"] == "supply.pressure"
    assert imported.recording.time[0] == 0.0
    assert imported.recording["supply.pressure"][0, 0] == pytest.approx(1e7)


def test_a_window_is_cut_in_seconds_from_the_first_row(lab):
    columns = {"t [s]": T + 1e6, "p [bar]": T}
    told = CLOCK + channel("p [bar]", "supply.pressure") + '[window]\nstart = "1 s"\nstop = 3\n'
    recording = lab(columns, told).recording
    assert len(recording) == 200
    assert recording["supply.pressure"][0, 0] == pytest.approx(1e5)
    other = lab(columns, told, Window(start=0.5, stop=0.75)).recording
    assert len(other) == 25
    with pytest.raises(VesTwinError, match="window"):
        lab(columns, told, Window(start=10.0, stop=20.0))


def test_several_rates_come_onto_one_clock_and_say_how(lab):
    told = f'rate = "20 Hz"\n{CLOCK}' + channel("x [mm]", "leg.length.1")
    told += channel("u [mm]", "leg.command.1")
    told += channel("x2 [mm]", "leg.length.2", 'way = "linear"')
    columns = {"t [s]": T, "x [mm]": 1e3 + T, "u [mm]": np.floor(T), "x2 [mm]": T}
    imported = lab(columns, told)
    assert np.allclose(np.diff(imported.recording.time), 0.05, atol=1e-12)
    ways = [c.how for c in imported.account.channels]
    assert "zero-phase FIR low-pass" in ways[0]
    assert ways[1:] == ["newest value held", "straight between rows"]
    assert set(np.round(imported.recording["leg.command"][:, 0], 6)) == {0, 0.001, 0.002, 0.003}


def test_gaps_and_repeats_are_reported_and_left_empty(lab):
    keep = (T < 1.0) | (T > 1.5)
    time = np.insert(T[keep], 10, T[10])
    told = f'rate = "100 Hz"\n{CLOCK}' + channel("x [mm]", "leg.length.1", 'way = "linear"')
    imported = lab({"t [s]": time, "x [mm]": 1e3 + time}, told)
    text = imported.account.to_text()
    assert "1 gaps, the longest of 0.52 s" in text
    assert "1 repeated times left out" in text
    empty = ~np.isfinite(imported.recording["leg.length"][:, 0])
    assert empty[102:149].all()
    assert empty.sum() < 55


def test_a_wrench_is_turned_and_moved_to_the_sensor(lab):
    # recorded in axes x' = y, y' = -x, z' = z, at a point 0.1 m along the sensor's z
    force, moment = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    names = ("Fx (N)", "Fy (N)", "Fz (N)", "Tx (Nm)", "Ty (Nm)", "Tz (Nm)")
    columns = {"t [s]": T} | {
        n: np.full(400, v) for n, v in zip(names, [*force, *moment], strict=True)
    }
    told = CLOCK + "".join(
        channel(n, f"sensor.wrench.{i}", 'frame = "tool"') for i, n in enumerate(names, 1)
    )
    told += '[frames.tool]\naxes = ["-y", "x", "z"]\norigin = [0.0, 0.0, 0.1]\n'
    found = lab(columns, told).recording["sensor.wrench"][0]
    assert np.allclose(found[:3], turn @ force)
    # power of any motion is the same in both places: F.v + M.w with v_tool = v + w x r
    for _ in range(5):
        v, w = np.random.default_rng(0).normal(size=(2, 3))
        at_tool = turn.T @ (v + np.cross(w, [0.0, 0.0, 0.1]))
        power = force @ at_tool + moment @ (turn.T @ w)
        assert found[:3] @ v + found[3:] @ w == pytest.approx(power)


@pytest.mark.parametrize(
    ("column", "unit", "values", "says"),
    [
        ("leg.length.1", "m", 1000.0 + 50.0 * np.sin(T), "mm taken for m is suspected"),
        ("arm.q.1", "rad", 60.0 * np.sin(T), "degrees taken for rad is suspected"),
        ("sensor.wrench.6", "N*m", 1e5 * np.sin(T), "mN m taken for N"),
        ("supply.pressure", "Pa", 207.0 + T, "bar taken for Pa is suspected"),
        ("leg.length.1", "m", 7.0 + T, "check unit and sign"),
    ],
)
def test_mixed_units_are_suspected_by_the_plants_ranges(lab, column, unit, values, says):
    ranges = signal_ranges(Plant.load("ves2"))
    told = CLOCK + channel("x", column, f'unit = "{unit}"')
    account = lab({"t [s]": T, "x": values}, told, plausible=ranges).account
    assert any(says in words for words in account.suspected), account.suspected
    assert "SUSPECTED" in account.to_text()


def test_right_units_raise_no_suspicion(lab):
    ranges = signal_ranges(Plant.load("ves2"))
    told = CLOCK + channel("L [mm]", "leg.length.1") + channel("q_deg", "arm.q.1")
    columns = {"t [s]": T, "L [mm]": 1050.0 + 60.0 * np.sin(T), "q_deg": 100.0 * np.sin(T)}
    assert lab(columns, told, plausible=ranges).account.suspected == ()


def test_two_recorders_are_aligned_or_the_offset_kept_as_a_hypothesis(lab):
    motion = np.sin(2.0 * T) + 0.5 * np.sin(5.3 * T + 1.0)
    late = np.sin(2.0 * (T + 0.123)) + 0.5 * np.sin(5.3 * (T + 0.123) + 1.0)
    columns = {"t [s]": T, "t_plc [s]": T + 7000.0, "L [mm]": 1e3 + motion, "s [mm]": 1e3 + late}
    told = CLOCK + channel("L [mm]", "leg.length.1")
    told += channel("s [mm]", "leg.length.2", 'clock = "plc"\nway = "linear"')
    told += (
        '[clocks.plc]\ncolumn = "t_plc [s]"\noffset = "estimate"\nown = "s [mm]"\nmain = "L [mm]"\n'
    )
    imported = lab(columns, told)
    offset = imported.recording.info.imported["offsets"]["plc"]
    # linear reading between rows 10 ms apart bends 5.3 rad/s by less than 4e-4 of 1 mm
    assert offset["value"] == pytest.approx(-7000.0 + 0.123, abs=1e-3)
    assert offset["removed"]
    inner = imported.recording["leg.length"][20:-20]
    assert np.nanmax(np.abs(inner[:, 1] - inner[:, 0])) < 1e-5
    kept = lab(columns, told + 'keep = "hypothesis"\n')
    assert not kept.recording.info.imported["offsets"]["plc"]["removed"]
    assert "kept as a hypothesis" in kept.account.to_text()
    inner = kept.recording["leg.length"][20:-20]
    assert np.nanmax(np.abs(inner[:, 1] - inner[:, 0])) > 1e-4


def test_a_rate_stands_in_for_a_clock_that_is_not_there(lab):
    told = '[clock]\nrate = "1 kHz"\n' + channel("p [bar]", "supply.pressure")
    recording = lab({"n": np.arange(400), "p [bar]": T}, told).recording
    assert np.allclose(recording.time, np.arange(400) * 1e-3)


@pytest.mark.parametrize(
    ("told", "says"),
    [
        (CLOCK + channel("p [ba]", "supply.pressure"), "did you mean 'p [bar]'"),
        (CLOCK + channel("p [bar]", "suply.pressure"), "did you mean 'supply.pressure'"),
        (CLOCK + channel("p [bar]", "leg.length.1"), "p [bar] for leg.length.1"),
        (CLOCK + channel("p [bar]", "supply.pressure", 'unit = "barr"'), "a unit, as in"),
        (CLOCK + channel("x", "arm.q.1"), "unit of x"),
        (CLOCK + channel("x", "arm.q.1", 'unit = "rad"\nclock = "pcl"'), "unknown clock"),
        (CLOCK + channel("x", "arm.q.1", 'unit = "rad"\nframe = "tol"'), "unknown frame"),
        (CLOCK + channel("x", "arm.q.1", 'unit = "rad"\nsing = -1'), "did you mean"),
        (CLOCK + channel("x", "arm.q.1", 'unit = "rad"\nsign = 2'), "sign"),
        (CLOCK + channel("x", "motor.current", 'unit = "A"'), "that --plant names"),
        (CLOCK.replace("t [s]", "time") + channel("p [bar]", "supply.pressure"), "time column"),
        ("[clock]\n" + channel("p [bar]", "supply.pressure"), "either column or rate"),
        ('[clock]\ncolumn = "x"\n' + channel("p [bar]", "supply.pressure"), "unit of x"),
        (CLOCK, "channel"),
        (CLOCK + 2 * channel("p [bar]", "supply.pressure"), "two columns go to"),
        (
            CLOCK + channel("p [bar]", "supply.pressure") + '[signals."leg.length"]\nunit = "m"\n',
            "one of the rig's",
        ),
        (
            CLOCK + channel("p [bar]", "supply.pressure") + '[signals."a, b"]\nunit = "m"\n',
            "words with points",
        ),
        (
            CLOCK
            + channel("p [bar]", "lab.force.10000000000")
            + '[signals."lab.force"]\nunit = "Pa"\n',
            "unknown signal column",
        ),
        ('rate = "1 THz"\n' + CLOCK + channel("p [bar]", "supply.pressure"), "at most"),
        (
            CLOCK + channel("p [bar]", "supply.pressure") + '[frames.a]\naxes = ["x", "y", "-z"]\n',
            "right-handed",
        ),
    ],
)
def test_a_wrong_map_gets_one_line_with_the_nearest_match(lab, told, says):
    with pytest.raises(VesTwinError) as caught:
        lab({"t [s]": T, "p [bar]": T, "x": T}, told)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_time_that_steps_back_is_refused_with_its_place(lab):
    time = T.copy()
    time[100:] -= 0.5
    told = CLOCK + channel("p [bar]", "supply.pressure")
    with pytest.raises(VesTwinError, match="1 steps back, first after row 100"):
        lab({"t [s]": time, "p [bar]": T}, told)
    cut = lab(
        {"t [s]": time, "p [bar]": T}, told.replace("[clock]\n", '[clock]\nbackward = "drop"\n')
    )
    assert "1 steps back" in cut.account.to_text()


def test_the_clock_of_an_mcap_log_is_chosen_by_its_column(mcap_file, tmp_path):
    zeros = {}
    for name in ("log_time", "publish_time", "stamp"):
        told = f'schema = 1\n[clock]\ncolumn = "{name}"\n' + channel(
            "/motor.q", "arm.q.1", 'unit = "rad"'
        )
        (tmp_path / "m.toml").write_text(told)
        found = import_log(open_log(mcap_file()), ImportMap.load(tmp_path / "m.toml"))
        zeros[name] = found.recording.info.imported["zero"]
        assert len(found.recording) == 200
    assert zeros["log_time"] - zeros["publish_time"] == pytest.approx(0.002)
    assert zeros["stamp"] == pytest.approx(0.0)


def test_every_range_belongs_to_a_signal_of_the_table():
    for name, (low, high) in signal_ranges(Plant.load("ves2")).items():
        assert low.shape == high.shape == (SIGNALS[name].width,)
        assert np.all(low < high)


@pytest.fixture
def two_rates(tmp_path):
    """A log of a fast and a slow topic on one clock, and its map."""
    path, told = tmp_path / "two.mcap", tmp_path / "two.toml"
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=2048)
        writer.start()
        schema = writer.register_schema("x", "jsonschema", b"{}")
        fast = writer.register_channel("/q", "json", schema)
        slow = writer.register_channel("/p", "json", schema)
        for i in range(1000):
            at = 10**18 + i * 5_000_000
            writer.add_message(fast, at, json.dumps({"v": 0.001 * i}).encode(), at)
            if i % 20 == 0:
                writer.add_message(slow, at, json.dumps({"v": float(i)}).encode(), at)
        writer.finish()
    text = 'schema = 1\n[clock]\ncolumn = "log_time"\n' + channel("/q.v", "arm.q.1", 'unit = "rad"')
    told.write_text(text + channel("/p.v", "supply.pressure", 'unit = "bar"'))
    return path, told


def test_a_slow_topic_is_held_and_marked_in_the_file(two_rates, tmp_path):
    path, told = two_rates
    imported = import_log(open_log(path), ImportMap.load(told))
    save_recording(imported.recording, tmp_path / "r.parquet")
    loaded = load_recording(tmp_path / "r.parquet")
    assert len(loaded) == 1000
    assert loaded.info.held == {"supply.pressure": pytest.approx(0.1)}
    assert np.array_equal(loaded["supply.pressure"][::20, 0], 1e5 * np.arange(0.0, 1000.0, 20.0))
    assert np.ptp(loaded["supply.pressure"][40:60]) == 0.0
    metadata = pq.read_schema(tmp_path / "r.parquet").field("supply.pressure").metadata
    assert float(metadata[b"held"]) == pytest.approx(0.1)


def test_of_a_file_that_was_cut_the_rest_is_imported_and_the_cut_is_told(two_rates):
    path, told = two_rates
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    imported = import_log(open_log(path), ImportMap.load(told))
    assert 100 < len(imported.recording) < 1000
    assert any("cut or damaged" in fault for fault in imported.account.faults)
    assert "not read: cut or damaged" in imported.account.to_text()
