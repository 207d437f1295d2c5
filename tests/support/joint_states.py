"""write_joint_states: an MCAP file of ROS 2 joint states."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mcap_ros2.writer import Writer

BAR = "=" * 80
DEFINITION = f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{BAR}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{BAR}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""

Message = tuple[int, int, Sequence[str], Mapping[str, Sequence[float]]]
"""Log time and stamp [ns], names of joints, and numbers by field."""


def write_joint_states(path: Path, messages: Iterable[Message]) -> Path:
    """Messages of /joint_states; fields that are left out are empty."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", DEFINITION)
        for at, stamped, names, fields in messages:
            stamp = {"sec": stamped // 10**9, "nanosec": stamped % 10**9}
            head = {"header": {"stamp": stamp, "frame_id": "base"}, "name": list(names)}
            numbers = {name: list(values) for name, values in fields.items()}
            writer.write_message("/joint_states", schema, head | numbers, at, at)
        writer.finish()
    return path
