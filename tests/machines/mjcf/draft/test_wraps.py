"""Angles of a joint that goes round are told within a turn by many encoders."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import changed, drafted

from ves_twin.machines.mjcf.recordings.columns import read_rig_recording


def test_a_joint_that_goes_round_is_read_as_it_turned_and_that_is_said(swing, write):
    path, columns = swing
    way = columns["q"] + 0.9 * columns["t"]
    told = (way + np.pi) % (2.0 * np.pi) - np.pi
    speed = columns["dq"] + 0.9
    log = write(changed(columns, q=told, dq=speed))
    found, rig = drafted(path, log)
    wraps = np.count_nonzero(np.abs(np.diff(told)) > np.pi)
    assert wraps > 1
    assert f"q wraps {wraps} times: whole turns are added" in found.look
    recording = read_rig_recording(log, rig)
    (angle,) = (n for n, c in rig.description.signals.items() if c.columns == ("q",))
    assert recording[angle][:, 0] - recording[angle][0, 0] == pytest.approx(way - way[0], abs=1e-6)
    (said,) = recording.info.imported["suspected"]
    assert said == f"log.csv: {angle} wraps {wraps} times: whole turns are added"
