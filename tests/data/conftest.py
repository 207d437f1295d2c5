"""Lab files that tests write: text tables, MAT files with opaque objects, MCAP logs."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from joint_states import write_joint_states
from mcap.writer import Writer

ROS1 = """Header header
float64 value
float32[3] force
MotorState[] motors
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: lab/MotorState
int16 current
"""

START = 1_700_000_000_000_000_000
"""Nanoseconds since 1970 of the first message."""


@pytest.fixture
def mcap_file(tmp_path):
    """JSON, ROS 2, ROS 1 and unreadable topics, with three times that differ."""

    def write(name="log.mcap", count=200, chunk_size=4096) -> Path:
        path = tmp_path / name
        with path.open("wb") as stream:
            writer = Writer(stream, chunk_size=chunk_size)
            writer.start()
            schema = writer.register_schema("motor", "jsonschema", b"{}")
            odd = writer.register_schema("odd", "flatbuffer", b"")
            joints = writer.register_channel("/motor", "json", schema)
            dark = writer.register_channel("/dark", "flatbuffer", odd)
            ros1 = writer.register_channel(
                "/old", "ros1", writer.register_schema("lab/Old", "ros1msg", ROS1.encode())
            )
            for i in range(count):
                at = START + i * 10_000_000
                message = {"q": float(np.sin(0.05 * i)), "u": [0.5 * i, -i], "mode": "run"}
                message["stamp"] = {"sec": at // 10**9, "nanosec": at % 10**9 - 4_000_000 * (i > 0)}
                writer.add_message(joints, at, json.dumps(message).encode(), at - 2_000_000)
                writer.add_message(dark, at, b"\1\2", at)
                writer.add_message(ros1, at, _ros1(i, at), at)
            writer.finish()
        return path

    return write


def _ros1(i: int, at: int) -> bytes:
    head = struct.pack("<III", i, at // 10**9, at % 10**9) + struct.pack("<I", 4) + b"base"
    motors = struct.pack("<Ihh", 2, i, -i)
    return head + struct.pack("<d3f", 0.25 * i, 1.0, 2.0, 3.0) + motors


@pytest.fixture
def ros2_file(tmp_path):
    """A ROS 2 topic of joint states, its stamps 3 ms before its log times."""
    at = [START + i * 5_000_000 for i in range(100)]
    turn = [{"position": [0.1 * i, -0.1 * i]} for i in range(100)]
    messages = ((t, t - 3_000_000, ("a", "b"), fields) for t, fields in zip(at, turn, strict=True))
    return write_joint_states(tmp_path / "ros2.mcap", messages)
