"""MCAP: topics as tables, three times, encodings that are read and named, files that are cut."""

import sys

import numpy as np
import pytest
from google.protobuf.timestamp_pb2 import Timestamp
from joint_states import write_joint_states
from mcap_protobuf.writer import Writer as ProtobufWriter

from ves_twin.core.errors import InvalidInputError, VesTwinError
from ves_twin.data.formats import mcap_log
from ves_twin.data.formats.message_fields import number_at, number_paths
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.formats.ros1_messages import ros1_decoder
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.inspection_text import inspection_text


def test_json_topics_have_their_numbers_and_three_times(mcap_file):
    log = open_log(mcap_file())
    found = log.read("/motor", ["log_time", "publish_time", "stamp", "q", "u[1]"])
    # nanoseconds are exact up to the rounding of doubles of seconds
    assert np.allclose(found["log_time"], np.arange(200) * 0.01, rtol=0, atol=1e-12)
    assert np.allclose(found["log_time"] - found["publish_time"], 0.002, atol=1e-12)
    assert np.allclose((found["log_time"] - found["stamp"])[1:], 0.004, atol=1e-12)
    assert np.array_equal(found["u[1]"], -np.arange(200.0))
    assert np.array_equal(found["q"], np.sin(0.05 * np.arange(200)))


def test_unreadable_encodings_are_named_and_keep_their_times(mcap_file):
    log = open_log(mcap_file())
    assert [c.name for c in log.table("/dark").columns] == ["log_time", "publish_time"]
    assert len(log.read("/dark", ["log_time"])["log_time"]) == 200
    assert any("/dark: flatbuffer messages" in fault for fault in log.faults)


def test_ros_2_messages_are_decoded(ros2_file):
    log = open_log(ros2_file)
    found = log.read("/joint_states", ["log_time", "header.stamp", "position[1]"])
    assert np.allclose(found["log_time"] - found["header.stamp"], 0.003, atol=1e-12)
    assert np.allclose(found["position[1]"], -0.1 * np.arange(100))


def states(tmp_path, told):
    """A log of joint states: names and positions of each message."""
    messages = (
        (10**15 + i * 5_000_000, 10**15, names, {"position": values})
        for i, (names, values) in enumerate(told)
    )
    return open_log(write_joint_states(tmp_path / "joints.mcap", messages))


def test_joint_states_are_called_by_their_joints_whatever_their_order(tmp_path):
    """Several nodes may publish on one topic, each the joints that it knows."""
    told = [(("a", "b"), [1.0, 2.0]), (("b", "a"), [4.0, 3.0]), (("b", "c"), [6.0, 7.0])] * 30
    log = states(tmp_path, told)
    said = {c.name: c.said for c in log.table("/joint_states").columns}
    columns = [f"position[{k}]" for k in range(3)]
    assert [said[name] for name in columns] == ["a.position", "b.position", "c.position"]
    assert said["header.stamp"] == said["log_time"] == ""
    found = log.read("/joint_states", columns)
    rows = ([1.0, 3.0, np.nan], [2.0, 4.0, 6.0], [np.nan, np.nan, 7.0])
    for name, row in zip(columns, rows, strict=True):
        assert np.array_equal(found[name], row * 30, equal_nan=True), name
    assert "b.position" in inspection_text(inspect_log(log))


def test_names_that_come_with_some_messages_alone_are_of_all(tmp_path):
    told = [((), [1.0, 2.0]), (("a", "b"), [3.0, 4.0]), ((), [5.0, 6.0])] * 30
    log = states(tmp_path, told)
    assert log.table("/joint_states").columns[-1].said == "b.position"
    found = log.read("/joint_states", ["position[0]"])["position[0]"]
    assert np.array_equal(found, [1.0, 3.0, 5.0] * 30)


def test_an_array_of_another_length_than_the_names_keeps_its_places(tmp_path):
    told = [(("a", "b"), [1.0, 2.0, 3.0]), (("b", "a"), [4.0, 5.0, 6.0])] * 30
    log = states(tmp_path, told)
    assert all(column.said == "" for column in log.table("/joint_states").columns)
    found = log.read("/joint_states", ["position[0]"])["position[0]"]
    assert np.array_equal(found, [1.0, 4.0] * 30)


def test_ros_1_messages_are_decoded_without_running_their_definition(mcap_file):
    before = set(sys.modules)
    found = open_log(mcap_file()).read("/old", ["value", "force[2]", "motors[1].current"])
    assert np.array_equal(found["value"], 0.25 * np.arange(200))
    assert np.array_equal(found["force[2]"], np.full(200, 3.0))
    assert np.array_equal(found["motors[1].current"], -np.arange(200.0))
    assert not [name for name in set(sys.modules) - before if "genpy" in name]


def test_a_ros_1_definition_that_is_none_is_refused():
    with pytest.raises(InvalidInputError, match="definition of a/B"):
        ros1_decoder("a/B", "import os; os.remove('x')")
    with pytest.raises(InvalidInputError, match="type of a message"):
        ros1_decoder("a/B", "B self")(b"")  # a type that holds itself


def test_protobuf_messages_are_decoded(tmp_path):
    path = tmp_path / "proto.mcap"
    with path.open("wb") as stream, ProtobufWriter(stream) as writer:
        for i in range(20):
            message = Timestamp(seconds=i, nanos=500)
            writer.write_message("/clock", message, i * 10**9, i * 10**9)
    found = open_log(path).read("/clock", ["seconds", "nanos"])
    assert np.array_equal(found["seconds"], np.arange(20.0))
    assert np.array_equal(found["nanos"], np.full(20, 500.0))


def test_a_file_that_was_cut_keeps_its_begin(mcap_file):
    path = mcap_file()
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    log = open_log(path)
    found = log.read("/motor", ["log_time", "q"])
    assert 50 < len(found["q"]) < 200
    assert np.array_equal(found["q"], np.sin(0.05 * np.arange(len(found["q"]))))
    assert any("cut or damaged" in fault for fault in log.faults)


def test_a_damaged_chunk_costs_only_itself(mcap_file):
    path = mcap_file()
    log = open_log(path)
    hurt = log._chunks[2]
    content = bytearray(path.read_bytes())
    content[hurt.chunk_start_offset + 200] ^= 0xFF
    path.write_bytes(bytes(content))
    log = open_log(path)
    rows = log.read("/motor", ["q"])["q"]
    assert 100 < len(rows) < 200
    assert any("chunk 3 of" in fault for fault in log.faults)


def test_a_topic_of_many_messages_is_sampled_for_a_look(mcap_file, monkeypatch):
    monkeypatch.setattr(mcap_log, "MANY", 100)
    monkeypatch.setattr(mcap_log, "SAMPLED", 50)
    inspection = inspect_log(open_log(mcap_file()))
    motor = next(t for t in inspection.tables if t.name == "/motor")
    assert motor.basis == "first 50 messages"
    assert motor.rows == 200  # the clock is read whole, from the index
    assert next(c for c in motor.channels if c.name == "/motor.u[0]").high == 24.5


def test_a_file_without_messages_gets_one_line(mcap_file):
    with pytest.raises(VesTwinError, match="0 messages"):
        open_log(mcap_file(count=0))


def test_without_the_extra_packages_one_line_names_them(monkeypatch, mcap_file):
    path = mcap_file()
    monkeypatch.delitem(sys.modules, "ves_twin.data.formats.mcap_log")
    monkeypatch.setitem(sys.modules, "mcap_ros2.decoder", None)
    with pytest.raises(VesTwinError, match=r"pip install 'ves_twin\[mcap\]'"):
        open_log(path)


def test_a_stamp_is_one_in_any_order_and_only_of_whole_numbers():
    seconds = {"sec": 5, "nanosec": 250_000_000}
    for message in ({"stamp": seconds}, {"stamp": dict(reversed(seconds.items()))}):
        assert list(number_paths(message)) == [("stamp",)]
        assert number_at(message, ("stamp",), 10**9) == pytest.approx(4.25, abs=1e-9)
    for wrong in ("a", 1e300, None, 10**30):
        message = {"stamp": {"sec": 5, "nanosec": wrong}}
        assert ("stamp",) not in number_paths(message)
        assert np.isnan(number_at(message, ("stamp",), 0))


def test_an_integer_beyond_doubles_is_no_number():
    assert np.isnan(number_at({"x": 10**400}, ("x",), 0))
