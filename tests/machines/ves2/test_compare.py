"""Comparing: a healthy run is noise, every hidden change is seen where it is."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.data.quality.check import Grade
from ves_twin.diagnosis.record.residuals.cells import Cell
from ves_twin.machines.compare import compare
from ves_twin.machines.comparison import Basis
from ves_twin.machines.machine import Named
from ves_twin.machines.ves2 import loop_noise
from ves_twin.report.comparison.page import comparison_page
from ves_twin.report.comparison.words import gap_sentence, place_sentence, trust_sentence
from ves_twin.scenario.experiment import Experiment
from ves_twin.simulator.simulate import simulate

pytestmark = pytest.mark.usefixtures("standing")

FAST = "ves2_pressure_fast"


def one(recording, **options):
    return compare([Named("run", recording)], **options).recordings[0]


@pytest.fixture(scope="module")
def healthy_result(healthy):
    assert loop_noise.simulate is simulate  # the rig stands here: `standing` comes later
    return one(healthy)


@pytest.fixture(scope="module")
def sticky_result(sticky):
    return one(sticky)


def test_the_plant_that_made_a_run_leaves_noise_of_one_sigma(healthy_result):
    assert healthy_result.beyond_noise == ()
    assert gap_sentence(healthy_result).startswith("Gap: none beyond noise in any of 25")
    noisy = [c for c in healthy_result.channels if c.signal in {"sensor.wrench", "arm.torque"}]
    for channel in noisy:
        # 634 rows with up to 0.4 of correlation tell an sd to 4 %; drift may add a half
        assert 0.85 < channel.rms_sigma < 1.5, channel.name
        assert channel.whiteness is not None, channel.name
        assert channel.whiteness.white, channel.name


def test_friction_in_a_leg_is_loudest_in_its_own_column(sticky_result):
    loud = {c.name: c for c in sticky_result.beyond_noise if c.signal == "leg.length"}
    assert list(loud) == ["leg.length.3"]
    lengths = {c.name: c.rms for c in sticky_result.channels if c.signal == "leg.length"}
    others = max(value for name, value in lengths.items() if name != "leg.length.3")
    assert lengths["leg.length.3"] > 5.0 * others
    assert "leg.command.3" in place_sentence(loud["leg.length.3"])


def test_an_error_that_is_there_in_motion_alone_is_largest_in_motion(sticky_result):
    """Less its mean, that of an elbow which stands for a fifth of its log is largest at rest."""
    moving = Cell("velocity", "elbow rising", rms=0.5, mean=0.4, sigma=1.0, score=1.0)
    still = Cell("velocity", "elbow still", rms=1.6, mean=-1.6, sigma=1.0, score=1.0)
    loud = max(sticky_result.channels, key=lambda c: c.rms_sigma)
    channel = replace(loud, mean=2.0, regimes=(moving, still))
    assert "; 6 times as large while elbow is rising as while it is still" in place_sentence(
        channel
    )


@pytest.mark.slow
def test_a_valve_that_is_off_null_is_a_constant_of_null_over_gain(faulty):
    """At rest the integrator needs null = K1 e / full speed, so e = 0.01 * 0.5 / 12.6."""
    run = faulty("valve_null", "leg.3", null=0.01)
    full_speed = vt.Plant.load("ves2_pressure").parameters.number("hydraulics.full_speed")
    found = {c.name: c for c in one(run).channels}["leg.length.3"]
    assert found.beyond_noise
    assert abs(found.mean) == pytest.approx(0.01 * full_speed / 12.6, rel=0.02)
    assert "a constant" in place_sentence(found)


@pytest.mark.slow
def test_a_length_offset_shows_at_the_sensor_not_in_the_lengths(faulty):
    """The leg loop makes the reading equal to its command, whatever the reading is worth."""
    result = one(faulty("length_offset", "leg.3", offset=3e-3))
    assert result.beyond_noise[0].signal == "sensor.wrench"
    mean = {c.name: abs(c.mean) for c in result.channels}["leg.length.3"]
    assert mean < 3e-5  # a hundredth of the offset


@pytest.mark.slow
def test_a_delay_of_a_signal_is_found_with_its_size(healthy, changed):
    def late(values):
        values[2:] = values[:-2].copy()

    period = healthy.info.period
    channels = {c.name: c for c in one(changed(healthy, "leg.length", late)).channels}
    lag = channels["leg.length.1"].lag
    assert lag.value == pytest.approx(2.0 * period, abs=0.02 * period)


def test_swapped_columns_fail_the_gate_on_the_first_screen(healthy, changed):
    def swap(values):
        values[:, [1, 4]] = values[:, [4, 1]]

    comparison = compare([Named("run", changed(healthy, "leg.length", swap))])
    result = comparison.recordings[0]
    assert result.quality is Grade.FAILED
    assert f"1 of {len(result.checks)} quality checks failed" in trust_sentence(result)
    page = comparison_page(comparison)
    assert page.index("leg.length.2 follows command 5") < page.index("<svg")


@pytest.mark.slow
def test_missing_numbers_are_left_out_and_named(healthy, changed):
    def lose(values):
        values[100:160, 2] = np.nan

    result = one(changed(healthy, "sensor.wrench", lose))
    lost = {c.name: c for c in result.channels}["sensor.wrench.3"]
    compared = len(healthy) - 10  # the last cycles are not compared
    assert lost.missing == pytest.approx(60 / compared)
    assert result.beyond_noise == ()
    assert result.quality is Grade.FAILED


@pytest.mark.slow
def test_a_short_hole_of_set_points_is_bridged_and_a_long_one_refused(healthy, changed):
    def lose(count):
        return changed(
            healthy, "leg.command", lambda v: v.__setitem__(slice(90, 90 + count), np.nan)
        )

    assert any("drawn across holes" in note for note in one(lose(3)).notes)
    with pytest.raises(InvalidInputError, match=r"leg\.command .*holes of at most 0\.25 s"):
        one(lose(80))


@pytest.mark.slow
def test_lost_rows_are_left_empty(healthy):
    keep = np.r_[0:200, 203 : len(healthy)]
    cut = {name: values[keep] for name, values in healthy.signals.items()}
    result = one(vt.Recording(healthy.time[keep], cut, healthy.info))
    assert any("3 rows are missing" in note for note in result.notes)
    assert result.beyond_noise == ()


@pytest.mark.slow
@pytest.mark.parametrize("rate", [50.0, 200.0])
def test_another_rate_is_compared_as_well(healthy, thinned, rate):
    """Set-points drawn straight at 50 Hz miss motion of 2.5 Hz by (pi f / r)^2 / 2 = 1 %."""
    result = one(thinned(healthy, rate))
    assert result.rate == pytest.approx(rate, rel=1e-6)
    explained = [c.unexplained for c in result.channels if c.signal == "leg.length"]
    assert max(explained) < 0.01


def test_missing_channels_are_named_and_the_rest_compared(healthy):
    kept = {n: v for n, v in healthy.signals.items() if n not in {"arm.torque", "sensor.wrench"}}
    result = one(replace(healthy, signals=kept))
    assert result.absent == ("sensor.wrench", "arm.torque")
    assert len(result.channels) == 16
    with pytest.raises(UnknownNameError, match=r"signal in the recording 'leg\.command'"):
        one(replace(healthy, signals={"leg.length": healthy["leg.length"]}))


@pytest.mark.slow
def test_before_and_after_differ_where_the_rig_changed(healthy, sticky, scenario):
    against = Named("before", healthy)
    result = compare([Named("after", sticky)], against=against).recordings[0]
    assert result.basis is Basis.RECORDING
    loud = [c.name for c in result.beyond_noise if c.signal in {"leg.length", "valve.command"}]
    assert sorted(loud) == ["leg.length.3", "valve.command.3"]
    again = vt.simulate(scenario, seed=9)
    same = compare([Named("after", again)], against=against).recordings[0]
    assert same.beyond_noise == ()


@pytest.mark.slow
def test_another_programme_is_compared_by_what_the_plant_leaves_of_each(healthy):
    amplitude = [0.02, 0.02, 0.02, 0.0, 0.0, 0.0]
    changes = {"plant": FAST, "run.duration": 8.0, "platform.motion.amplitude": amplitude}
    other = vt.simulate(vt.Scenario.load("identify_fast", changes), seed=5)
    result = compare([Named("a", healthy)], against=Named("b", other)).recordings[0]
    assert result.basis is Basis.RESIDUAL
    assert any("another programme than b: leg.command.1 differs" in note for note in result.notes)
    assert result.beyond_noise == ()


@pytest.mark.slow
def test_an_emulation_run_tells_what_the_gap_costs(beam_short):
    """A bias of 2 N in x at the sensor: 2 of the 1 N allowed, and it moves the emulated beam."""
    biased = beam_short["sensor.wrench"] + np.array([2.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    plain = one(beam_short).cost
    cost = one(replace(beam_short, signals={**beam_short.signals, "sensor.wrench": biased})).cost
    assert cost.force == pytest.approx(np.hypot(2.0, plain.force), rel=0.1)
    assert cost.force_share > 2.0
    assert cost.base_translation + cost.base_rotation > plain.base_translation


@pytest.mark.slow
def test_a_window_compares_only_its_rows(healthy):
    told = Experiment.model_validate({"window": {"start": "2 s", "stop": 6.0}})
    result = one(healthy, experiment=told)
    assert result.start == pytest.approx(2.0, abs=0.02)
    assert result.stop == pytest.approx(6.0, abs=0.02)
    assert result.beyond_noise == ()


@pytest.mark.slow
def test_a_recording_that_begins_in_motion_forgets_its_start(healthy):
    """From cycle 240 on: the legs' ticks (5, 3) come round to the cycle's (37) every 15 cycles."""
    tail = healthy.window(healthy.time[240] - 1e-6, 9.0)
    told = Experiment.model_validate({"start": {"state": "estimated", "forget": 2.0}})
    result = one(tail, experiment=told)
    loud = [c.name for c in result.beyond_noise if c.signal == "leg.length"]
    assert loud == []


@pytest.mark.slow
def test_an_undeclared_payload_is_seen_and_a_declared_one_is_not(scenario):
    from ves_twin.plant.known_weight import hang_weight

    run = vt.simulate(scenario, hang_weight(vt.Plant.load(FAST), 1.0), seed=6)
    assert one(run).beyond_noise
    assert one(run, experiment=Experiment(payload=1.0)).beyond_noise == ()


@pytest.mark.slow
def test_the_result_is_json_and_the_page_stands_alone(sticky):
    comparison = compare([Named("<b>&run", sticky)])
    content = json.loads(json.dumps(comparison.to_dict(), allow_nan=False))
    assert content["recordings"][0]["channels"]["leg.length.3"]["unit"] == "m"
    page = comparison_page(comparison)
    assert len(page.encode()) < 5e6
    assert "<b>&run" not in page
    assert "&lt;b&gt;&amp;run" in page
    assert "<script" not in page
    assert 'src="' not in page
