"""send_three_bodies: the machine as measured, by the model before and after, in one place."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
import rerun as rr

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.verdict.report_traces import Traces
from ves_twin.machines.drawing import Drawing
from ves_twin.report.colours import AFTER, BEFORE, MEASURED, rgb
from ves_twin.report.rerun.poses import frame_rows
from ves_twin.report.rerun.shapes import send_shapes

OPACITIES, GROWTH = (90, 60), 0.004
"""Of the two models, which lie over the measured machine [of 255]; how far each stands out, as a
share of the machine's size."""


def send_three_bodies(
    stream: rr.RecordingStream,
    root: str,
    drawing: Drawing,
    channels: Sequence[Channel],
    traces: Traces,
) -> bool:
    """Send rN/bodies/MODEL/BODY over `sim_time`; the floor once.

    Args:
        stream: where it goes.
        root: entity of the recording.
        drawing: bodies, and what places them.
        channels: of the traces.
        traces: one recording.

    Returns:
        Whether there was anything to draw: every signal that places the machine was recorded.
    """
    recorded = [channel.signal for channel in channels]
    if any(recorded.count(name) < columns for name, columns in drawing.needs.items()):
        return False
    rows = frame_rows(traces.time)
    rows = rows[np.isfinite(traces.measured[rows]).all(axis=1)]
    names = tuple(drawing.model.body(i).name for i in range(1, drawing.model.nbody))
    send_shapes(stream, root, drawing.model, ("world",))
    out, (there, here) = GROWTH * float(drawing.model.stat.extent), OPACITIES
    models = (
        ("measured", MEASURED, traces.measured, 255, 0.0),
        ("before", BEFORE, traces.nominal, there, out),
        ("after", AFTER, traces.fitted, here, 2.0 * out),
    )
    times = [rr.TimeColumn("sim_time", duration=traces.time[rows])]
    for name, colour, values, opacity, growth in models:
        entity = f"{root}/{name}"
        send_shapes(stream, entity, drawing.model, names, (*rgb(colour), opacity), growth)
        qpos = drawing.place(_signals(channels, values[rows]))
        position, turn = _poses(drawing.model, qpos)
        for i, body in enumerate(names):
            poses = rr.Transform3D.columns(translation=position[:, i], quaternion=turn[:, i])
            stream.send_columns(f"{entity}/{body}", times, poses)
    return True


def _signals(channels: Sequence[Channel], values: SingleArray) -> dict[str, FloatArray]:
    """Rows (n, width) of each signal; columns that were not recorded are zero."""
    found: dict[str, FloatArray] = {}
    for name in dict.fromkeys(channel.signal for channel in channels):
        own = [(c, channel.column) for c, channel in enumerate(channels) if channel.signal == name]
        rows = np.zeros((len(values), max(column for _, column in own) + 1))
        for c, column in own:
            rows[:, column] = values[:, c]
        found[name] = rows
    return found


def _poses(model: mujoco.MjModel, qpos: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Origins [m] (n, bodies, 3) and quaternions x, y, z, w (n, bodies, 4), the world left out."""
    data = mujoco.MjData(model)
    position = np.empty((len(qpos), model.nbody - 1, 3))
    turn = np.empty((len(qpos), model.nbody - 1, 4))
    for k, row in enumerate(qpos):
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        position[k], turn[k] = data.xpos[1:], data.xquat[1:, [1, 2, 3, 0]]
    return position, turn
