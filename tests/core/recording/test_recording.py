"""Recordings keep their rows, units and origin through every kind of file."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

import ves_twin as vt
from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.recording.recording import Event, Recording, RecordingInfo
from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME, RecordingStream
from ves_twin.core.signals import SIGNALS

INFO = RecordingInfo(origin="simulated", scenario="x", seed=7, held={"leg.command": 0.01})
NAMES = ("leg.length", "supply.pressure")


def rows(start: int, count: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    time_ = np.arange(start, start + count) * 0.1
    return time_, {"leg.length": np.outer(time_, np.ones(6)), "supply.pressure": time_[:, None]}


def test_saved_and_loaded_recording_is_the_same(tmp_path):
    time_, signals = rows(0, 50)
    info = RecordingInfo(origin="measured", events=(Event(1.0, "start", "by hand"),))
    save_recording(Recording(time_, signals, info), tmp_path / "r.parquet")
    loaded = load_recording(tmp_path / "r.parquet")
    assert np.array_equal(loaded.time, time_)
    assert np.array_equal(loaded["leg.length"], signals["leg.length"])
    assert loaded.info == info


def test_columns_are_numbered_from_one_and_carry_their_metadata(tmp_path):
    with RecordingStream(tmp_path, NAMES, INFO) as stream:
        stream.write(*rows(0, 3))
        path = stream.finish(INFO)
    schema = pq.read_schema(path)
    assert schema.names[:3] == ["t", "leg.length.1", "leg.length.2"]
    assert "supply.pressure" in schema.names
    metadata = schema.field("leg.length.6").metadata
    assert metadata[b"unit"] == b"m"
    assert metadata[b"role"] == b"measurement"
    assert not (tmp_path / STREAM_NAME).exists()


def test_slower_signals_are_marked_as_held(tmp_path):
    run = vt.simulate(
        vt.Scenario.load(
            "position_sine", {"run.duration": 0.1, "run.log": "tick", "run.settle": 0.2}
        )
    )
    assert run.info.held["leg.command"] == pytest.approx(37 * 341e-6)
    assert run.info.held["valve.command"] == pytest.approx(5 * 341e-6)
    changes = np.flatnonzero(np.any(np.diff(run["valve.command"], axis=0) != 0, axis=1)) + 1
    assert set(changes % 5) == {0}


def test_stream_that_was_cut_is_read_up_to_its_last_whole_batch(tmp_path):
    stream = RecordingStream(tmp_path, NAMES, INFO)
    for start in (0, 10, 20):
        stream.write(*rows(start, 10))
    stream.close()
    path = tmp_path / STREAM_NAME
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - 200])
    loaded = load_recording(tmp_path)
    assert len(loaded) == 20
    assert loaded.info.outcome == "unfinished"
    path.write_bytes(whole[:40])
    with pytest.raises(FileAccessError, match="cut before"):
        load_recording(path)


def test_unfinished_run_in_a_used_folder_is_not_hidden_by_the_old_one(tmp_path):
    with RecordingStream(tmp_path, NAMES, INFO) as first:
        first.write(*rows(0, 5))
        first.finish(INFO)
    second = RecordingStream(tmp_path, NAMES, INFO)
    second.write(*rows(0, 8))
    second.close()
    assert len(load_recording(tmp_path)) == 8


@pytest.mark.parametrize(
    "damage",
    [
        lambda t: t.drop_columns(["leg.length.3"]),
        lambda t: t.rename_columns(["t", *[f"x{i}" for i in range(t.num_columns - 1)]]),
        lambda t: t.set_column(0, "t", [["a"] * len(t)]),
        lambda t: t.set_column(0, "t", [[float("nan")] * len(t)]),
        lambda t: t.replace_schema_metadata({b"ves_twin": b"[1, 2]"}),
        lambda t: t.replace_schema_metadata({b"ves_twin": b'{"origin": "x", "versions": 3}'}),
    ],
    ids=["a leg lost", "renamed", "text time", "nan time", "metadata a list", "versions a number"],
)
def test_damaged_recording_is_refused_in_one_line(tmp_path, damage):
    path = tmp_path / "r.parquet"
    time_, signals = rows(0, 5)
    save_recording(Recording(time_, signals, INFO), path)
    pq.write_table(damage(pq.read_table(path)), path)
    with pytest.raises((InvalidInputError, FileAccessError)) as caught:
        load_recording(path)
    assert "\n" not in str(caught.value)


def test_rows_of_a_killed_run_are_not_overwritten(tmp_path):
    stream = RecordingStream(tmp_path, NAMES, INFO)
    stream.write(*rows(0, 10))
    stream.close()
    with RecordingStream(tmp_path, NAMES, INFO) as second:
        second.write(*rows(0, 5))
        second.finish(INFO)
    assert len(load_recording(tmp_path / f"previous-{STREAM_NAME}")) == 10
    assert len(load_recording(tmp_path)) == 5


def test_time_that_steps_back_is_refused():
    with pytest.raises(
        InvalidInputError, match=r"0\.1 s after 0\.2 s in row 3.*strictly increasing"
    ):
        Recording(np.array([0.0, 0.2, 0.1]), {}, INFO)


def test_signal_of_another_length_is_refused():
    with pytest.raises(InvalidInputError, match=r"leg\.length"):
        Recording(np.arange(3.0), {"leg.length": np.zeros((2, 6))}, INFO)


def test_unknown_signal_is_answered_with_the_nearest():
    recording = Recording(np.arange(2.0), {"leg.length": np.zeros((2, 6))}, INFO)
    with pytest.raises(UnknownNameError, match=r"did you mean 'leg\.length'"):
        recording["leg.lenght"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.parquet", b"PAR1 nothing"),
        ("a.parquet", b""),
        ("a.arrows", b""),
        ("a.arrows", b"\0" * 99),
    ],
)
def test_file_that_is_no_recording_is_refused_in_one_line(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises((FileAccessError, InvalidInputError)) as caught:
        load_recording(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_parquet_of_somebody_else_is_refused(tmp_path):
    import pyarrow as pa

    pq.write_table(pa.table({"a": [1, 2]}), tmp_path / "a.parquet")
    with pytest.raises(InvalidInputError, match="written by ves-twin"):
        load_recording(tmp_path / "a.parquet")


def test_window_keeps_the_rows_within():
    time_, signals = rows(0, 50)
    part = Recording(time_, signals, INFO).window(1.0, 2.0)
    assert part.time[0] == 1.0
    assert len(part) == 10


def test_every_signal_of_the_contract_is_recorded(beam_short):
    contract = {
        "leg.command": 6, "leg.length": 6, "valve.command": 6, "platform.command": 6,
        "platform.pose": 6, "sensor.wrench": 6, "gravity.estimate": 6, "arm.command": 3,
        "arm.q": 3, "arm.torque": 3, "supply.pressure": 1, "reference.pose": 6,
        "truth.pose": 6, "truth.wrench": 6, "truth.leg_bending": 12,
    }  # fmt: skip
    for name, width in contract.items():
        assert beam_short[name].shape == (len(beam_short), width)
        assert SIGNALS[name].width == width


def test_pose_from_lengths_is_the_true_pose_but_for_bending_and_noise(beam_short):
    error = beam_short["platform.pose"] - beam_short["truth.pose"]
    # legs bend by milliradians and the transducers do not see it: well below a millimetre
    assert np.max(np.abs(error[:, :3])) < 5e-4
    assert np.max(np.abs(error)) > 0.0


@pytest.mark.slow
def test_rows_streamed_a_second_before_a_kill_are_readable(tmp_path):
    """kill -9 a long run; what was streamed a second before is there for every reader."""
    command = [
        *(sys.executable, "-m", "ves_twin.cli.main", "run", "beam_horizontal_truth"),
        *("--set", "run.duration=600", "--out", str(tmp_path)),
    ]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    stream = tmp_path / STREAM_NAME
    try:
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and not (stream.exists() and stream.stat().st_size > 1e6):
            time.sleep(0.05)
        seen = load_recording(tmp_path).time[-1]
        time.sleep(1.0)
    finally:
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
    assert not (tmp_path / FILE_NAME).exists()
    recording = load_recording(tmp_path)
    assert recording.time[-1] >= seen + 1.0  # it runs faster than real time
    assert recording.time[0] == 0.0
    assert recording.info.outcome == "unfinished"
    read = subprocess.run(
        [sys.executable, "-c", "import sys, ves_twin as vt; print(len(vt.load_recording(sys.argv[1])))", str(stream)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert int(read.stdout) == len(recording)


def test_folder_that_cannot_be_written_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    scenario = vt.Scenario.load("position_sine", {"run.duration": 0.1})
    with pytest.raises(FileAccessError, match="cannot write"):
        vt.record(scenario, Path(tmp_path / "file" / "out"))
