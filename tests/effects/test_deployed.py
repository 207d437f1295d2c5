"""A deployed program with other numbers is the scenario with those numbers, to the last bit."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError

SHORT = {"run.duration": 0.5, "run.settle": 0.3, "legs.filter": "error"}


def run(*effects, scenario="position_sine", **changes) -> vt.Recording:
    chosen = vt.Scenario.load(scenario, SHORT | changes)
    return vt.simulate(chosen, vt.Plant.load(chosen.plant).extended(*effects))


@pytest.mark.parametrize(
    ("effect", "key", "value"),
    [
        (vt.effects.LegGain("legs", share=0.25), "legs.gain", 12.6 * 1.25),
        (vt.effects.LegRateGain("legs", change=0.05), "legs.rate_gain", 0.05),
        (vt.effects.FilterEdge("legs", share=0.2), "legs.edge", 9.0 * 1.2),
    ],
)
def test_a_leg_loop_with_other_numbers_is_one_that_was_meant_so(effect, key, value):
    deployed, meant = run(effect), run(**{key: value})
    for signal in ("leg.length", "valve.command", "sensor.wrench"):
        np.testing.assert_array_equal(deployed[signal], meant[signal])
    assert not np.array_equal(deployed["leg.length"], run()["leg.length"])


def test_commands_beyond_the_limit_are_cut_and_others_are_not():
    fast = {
        "platform.motion.fade": 0.1,
        "platform.motion.frequency": [1.0] * 6,
        "platform.motion.amplitude": [0.0, 0.0, 0.05, 0.0, 0.0, 0.0],
    }
    free = run(**fast)["valve.command"]
    cut = run(vt.effects.CommandLimit("legs", tightness=3.0), **fast)["valve.command"]
    assert np.abs(free).max() > 0.3
    assert np.abs(cut).max() == 0.25
    first = int(np.argmax(np.any(np.abs(cut) == 0.25, axis=1)))
    np.testing.assert_array_equal(cut[:first], free[:first])
    # a looser limit than any command is no limit
    wide = 1.0 / np.abs(free).max() - 1.0
    same = run(vt.effects.CommandLimit("legs", tightness=0.9 * wide), **fast)["valve.command"]
    np.testing.assert_array_equal(same, free)


def test_an_edge_of_a_filter_that_is_not_there_is_refused():
    with pytest.raises(InvalidInputError, match=r"edge of the deployed leg filter.*legs\.filter"):
        run(vt.effects.FilterEdge("legs", share=0.1), **{"legs.filter": "none"})
