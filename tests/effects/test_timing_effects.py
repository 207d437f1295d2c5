"""The same delay at four places: what each moves, and what it leaves as it was."""

from functools import cache

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError

LATE = 2.3e-3
"""s; 6.7 ticks, so that whole ticks and a share of one are both tested."""
MOVING = {
    "run.duration": 0.6,
    "run.settle": 0.5,
    "run.noise": False,
    "run.log": "tick",
    "platform.motion.fade": 0.2,
    "platform.motion.frequency": [0.9, 1.1, 1.3, 1.0, 1.2, 0.8],
    "platform.motion.amplitude": [0.03, 0.03, 0.03, 0.05, 0.05, 0.06],
    "arm.moves": [{"start": 0.1, "duration": 0.45, "to": [0.1, 1.4, 0.1]}],
}
PLANT = vt.Plant.load("ves2").with_values(
    {
        "transducer.resolution": 0.0,
        "sensor.resolution": [0.0] * 6,
        "arm.encoder_resolution": [0.0] * 3,
    }
)


@cache
def run(*effects) -> vt.Recording:
    return vt.simulate(vt.Scenario.load("position_sine", MOVING), PLANT.extended(*effects))


def shifted(signal: str) -> np.ndarray:
    """A signal of the healthy rig, LATE seconds later."""
    time, values = run().time, run()[signal]
    columns = [np.interp(time - LATE, time, column) for column in values.T]
    return np.column_stack(columns)


def test_a_late_sensor_reads_the_wrench_of_earlier_and_moves_nothing():
    """Low-pass and delay are linear and commute; zeroing on a rig that still rings may shift."""
    late = run(vt.effects.SensorDelay("sensor", delay=LATE))
    gap = (late["sensor.wrench"] - shifted("sensor.wrench"))[20:]
    assert np.ptp(gap, axis=0).max() < 1e-8  # N, N m: round-off of hundreds through a low-pass
    for same in ("truth.wrench", "truth.pose", "leg.length", "arm.q"):
        np.testing.assert_array_equal(late[same], run()[same])


def test_a_late_drive_moves_the_arm_later_and_records_the_command_as_it_was():
    """The platform under it is not late, so that a tenth of the change may be other."""
    late = run(vt.effects.DriveDelay("arm", delay=LATE))
    np.testing.assert_array_equal(late["arm.command"], run()["arm.command"])
    change = np.abs(shifted("arm.q") - run()["arm.q"]).max()
    assert np.abs(late["arm.q"] - shifted("arm.q")).max() < 0.1 * change


def test_a_delay_before_and_behind_the_leg_loop_reads_the_same_and_is_not_the_same():
    """y = D P C (r - y) for either place: recorded lengths cannot part them, the pose can."""
    reading = run(*(vt.effects.TransducerDelay(f"leg.{i}", delay=LATE) for i in range(1, 7)))
    acting = run(vt.effects.ValveDelay("legs", delay=LATE))
    change = np.abs(acting["leg.length"] - run()["leg.length"]).max()
    # 0.3 %: clocks of 5 and 3 ticks lie between the two places
    assert np.abs(acting["leg.length"] - reading["leg.length"]).max() < 3e-3 * change
    assert np.abs(acting["truth.pose"] - reading["truth.pose"]).max() > 0.5 * change


def test_a_rig_with_delays_repeats_from_a_snapshot_to_the_last_bit():
    effects = (
        vt.effects.TransducerDelay("leg.2", delay=LATE),
        vt.effects.ValveDelay("legs", delay=LATE),
        vt.effects.SensorDelay("sensor", delay=LATE),
        vt.effects.DriveDelay("arm", delay=LATE),
    )
    sim = vt.Simulator(PLANT.extended(*effects), vt.Scenario.load("position_sine", MOVING))
    sim.advance(0.1)
    snapshot, ends = sim.snapshot(), []
    for _ in range(2):
        sim.restore(snapshot)
        sim.advance(0.05)
        ends.append((sim.rig.state.tobytes(), sim.rig.board.block.tobytes()))
    assert ends[0] == ends[1]


def test_a_delay_that_this_tick_has_no_room_for_is_refused():
    short = PLANT.with_values({"clock.tick": 1e-4, "clock.leg_ticks": 17})
    late = short.extended(vt.effects.SensorDelay("sensor", delay=0.015))
    with pytest.raises(InvalidInputError, match="delay of the wrench"):
        vt.Simulator(late, vt.Scenario.load("position_sine", MOVING))
