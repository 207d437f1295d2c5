"""Two real data sets, diagnosed end to end: what is named, what is rejected, how good it is."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.machines.compare import compare
from ves_twin.machines.data_folder import find_data
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(900)]
"""A minute of processor time each diagnosis, several on a busy machine."""

QUICK = Settings(nulls=40)
"""Thresholds matter little where causes stand out by thousands of chi^2."""

PUBLISHED = {"mass": 95.1089, "damping": 203.5034, "level": 20.3935}
"""Janot, Gautier, Brunot 2019 [kg, N s/m, N]."""


def recording(name, data_folder):
    rig = Rig.load(name)
    return rig, read_rig_recording(
        find_data(rig.description.data[0].file, rig.description.data, str(data_folder)), rig
    )


def labels(verdict):
    return {f"{c.effect}@{c.target}" for c in verdict.causes}


@pytest.fixture(scope="module")
def emps(data_folder):
    rig, rec = recording("emps", data_folder)
    fitted, held = alternate(rec, rig.description.block)
    return rec, diagnose(fitted, rig, held_out=held, settings=QUICK)


def test_emps_has_friction_of_two_kinds_that_depends_on_direction_and_nothing_else(emps):
    verdict = emps[1].verdict
    assert verdict.verdict is Kind.PARTIAL
    assert labels(verdict) == {
        "viscous_friction@axis",
        "coulomb_friction@axis",
        "viscous_asymmetry@axis",
    }
    assert all(cause.firm for cause in verdict.causes)


def test_emps_numbers_are_the_published_ones_to_one_per_cent(emps):
    verdict = emps[1].verdict
    found = {n: e.value for c in verdict.causes for n, e in c.parameters.items()}
    found["mass"] = verdict.tuned["body_mass@carriage:mass"].value
    for name, published in PUBLISHED.items():
        assert found[name] == pytest.approx(published, rel=0.01), name


def test_emps_force_on_laps_that_were_held_out(emps, figure):
    before, after = emps[1].verdict.gain.errors["motor.force"]
    assert before == pytest.approx(37.7, rel=0.02)  # mass alone, the reference fit
    figure("EMPS: force error on held-out laps (mass alone: 37.7 N)", after, 1.3, "N")
    assert emps[1].refused == ""


def test_emps_position_in_closed_loop_simulation(emps, figure):
    rec, found = emps

    def error(rig):
        (closed,) = [c for c in compare([rec], rig).recordings if c.mode == Mode.REFERENCE]
        return next(c.rms for c in closed.channels if c.name == "axis.position")

    assert error(Rig.load("emps")) == pytest.approx(27.6e-6, rel=0.02)  # reference simulation
    figure(
        "EMPS: position error in closed loop (mass alone: 27.6 um)",
        error(found.extended),
        2e-6,
        "m",
    )


def test_emps_without_friction_in_the_library_names_neither_mass_delay_nor_backlash(data_folder):
    rig, rec = recording("emps", data_folder)
    fitted, held = alternate(rec, rig.description.block)
    friction = ["viscous_friction", "coulomb_friction", "viscous_asymmetry"]
    friction += ["coulomb_asymmetry", "force_offset"]
    found = diagnose(fitted, rig, held_out=held, exclude=friction, settings=QUICK)
    assert found.verdict.verdict is Kind.UNKNOWN
    assert found.extended is None


@pytest.fixture(scope="module", params=[(10, 0.08), (5, 0.05)], ids=["blocks of 10", "of 5"])
def wrist(request, data_folder):
    rig, rec = recording("ft_wrist", data_folder)
    fitted, held = alternate(rec, request.param[0])
    return request.param, diagnose(fitted, rig, held_out=held, settings=QUICK)


def test_the_wrist_drifts_along_z_and_has_neither_another_tool_nor_another_gain(wrist, figure):
    (block, limit), found = wrist
    verdict = found.verdict
    assert verdict.verdict in (Kind.SEVERAL, Kind.PARTIAL, Kind.NAMED)
    assert "sensor_wander@wrist.force.3" in labels(verdict)
    assert {c.effect for c in verdict.causes} == {"sensor_wander"}
    force = [c.target for c in verdict.causes if c.target.startswith("wrist.force")]
    assert force == ["wrist.force.3"]
    after = [verdict.gain.errors[f"wrist.force.{i}"][1] for i in (1, 2, 3)]
    rms = float(np.sqrt(np.mean(np.square(after))))
    figure(f"Wrist sensor: held-out force error, blocks of {block} poses", rms, limit, "N")


def test_drift_of_the_wrist_cannot_be_carried_on_and_the_verdict_says_so(wrist):
    found = wrist[1]
    before, after = found.verdict.forecast.errors["wrist.force.3"]
    assert after > 3.0 * before
    assert not found.verdict.forecast.carries_on
    assert "cannot be carried on beyond them" in found.verdict.words
    assert "not beyond their end" in found.refused


@pytest.fixture(scope="module")
def undrifted(data_folder):
    """The wrist without drift in its library: least squares would say mass +5.5 or gain +8 %."""
    rig, rec = recording("ft_wrist", data_folder)
    fitted, held = alternate(rec, 10)
    return diagnose(fitted, rig, held_out=held, exclude=["sensor_wander"], settings=QUICK)


def test_without_drift_in_the_library_no_tool_is_named_and_nothing_firmly(undrifted):
    causes = undrifted.verdict.causes
    assert not [c for c in causes if c.effect == "body_mass" or c.firm]
    assert all(abs(c.parameters["gain"].value) < 0.04 for c in causes if c.effect == "sensor_gain")


@pytest.mark.xfail(
    strict=True,
    reason="a gain of +3 % predicts alternate stretches better, as they share the drift",
)
def test_without_drift_in_the_library_nothing_is_extended(undrifted):
    assert undrifted.verdict.verdict is Kind.UNKNOWN
    assert undrifted.extended is None
