"""Laws of every kind of effect that any rig can have."""

from __future__ import annotations

from typing import get_type_hints

import numpy as np
import pytest
from two_link import TARGETS, programme, rig, write_files

from ves_twin.core.errors import VesTwinError
from ves_twin.machines.mjcf.description import Mode
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.mjcf.registry import RIG_EFFECTS

FED = programme()
MODES = tuple(Mode)


@pytest.fixture(scope="module")
def forwards(tmp_path_factory):
    machine = rig(tmp_path_factory.mktemp("rig"))
    return {mode: MjcfForward.of(machine, mode) for mode in MODES}


def test_every_kind_is_final_has_a_source_and_is_tried_here():
    for name, kind in RIG_EFFECTS.items():
        assert getattr(kind, "__final__", False), name
        assert kind.source
        assert get_type_hints(kind)
    assert set(TARGETS) == set(RIG_EFFECTS.built_in)


@pytest.mark.parametrize("mode", MODES)
def test_nominal_values_change_nothing_to_the_last_bit(forwards, mode):
    forward = forwards[mode]
    told = forward.simulate(FED, {p.name: p.nominal for p in forward.parameters})
    assert np.array_equal(told, forward.simulate(FED, {}))
    assert np.all(np.isfinite(told))


def test_every_parameter_moves_a_signal_in_some_mode(forwards):
    still = set()
    for mode, forward in forwards.items():
        sd = np.array([c.sd for c in forward.channels])
        beside = {}  # a gap says nothing where the friction behind it has no level
        for h in forward.hypotheses:
            for start in h.starts[:1]:
                beside |= {
                    name: dict(zip(h.parameters, start, strict=True)) for name in h.parameters
                }
        for p in forward.parameters:
            others = beside.get(p.name, {})
            values = others | {p.name: p.nominal + 0.2 * (p.high - p.nominal)}
            moved = np.max(
                np.abs(forward.simulate(FED, values) - forward.simulate(FED, others)) / sd
            )
            if moved > 1.0:
                still.discard(p.name)
            elif mode is MODES[0]:
                still.add(p.name)
    assert not still


LARGE = """
[[effects]]
kind = "body_mass"
on = ["arm"]
largest = "6 kg"

[[effects]]
kind = "body_inertia"
on = ["cart"]
largest = 3
"""


def test_no_bound_asks_for_a_body_without_mass_or_inertia(tmp_path):
    """An arm of 1 kg that may be off by 6 kg is no arm of -5 kg."""
    forward = MjcfForward.of(rig(tmp_path, more=LARGE))
    found = {p.name: p for p in forward.parameters}
    mass, share = found["body_mass@arm:mass"], found["body_inertia@cart:share"]
    assert (mass.low, mass.high) == pytest.approx((0.01, 7.0))
    assert (share.low, share.high) == pytest.approx((-0.99, 3.0))
    assert all(
        p.low >= 0.0
        for p in forward.parameters
        if p.name.startswith(("viscous_friction", "coulomb_friction"))
    )
    for name in (mass.name, share.name):
        assert np.all(np.isfinite(forward.simulate(FED, {name: found[name].low})))


def test_bounds_are_those_of_the_file_where_it_has_them(tmp_path):
    told = """
[[parameters]]
joint = "rail"
attribute = "damping"
low = 2
high = "5 N*s/m"
"""
    found = {p.name: p for p in rig(tmp_path, more=told).parameters}
    damping = found["viscous_friction@rail:damping"]
    assert (damping.low, damping.nominal, damping.high) == (2.0, 4.0, 5.0)
    path = write_files(tmp_path, more=told.replace("low = 2", "low = 4.5"))
    with pytest.raises(VesTwinError, match=r"viscous_friction of rail.*expected 4 within them"):
        Rig.load(str(path))


@pytest.mark.parametrize("mode", [Mode.CONTROL, Mode.REFERENCE])
@pytest.mark.parametrize("more", [{}, {"force_offset@rail:offset": 1.0}])
def test_a_run_that_mujoco_had_to_reset_is_none(forwards, mode, more, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its log where it runs
    found = forwards[mode].simulate(FED, {"body_mass@arm:mass": -0.5, **more})
    assert np.isnan(found).all()


def test_the_smallest_size_of_interest_is_below_the_largest_and_both_are_positive(forwards):
    for hypothesis in forwards[Mode.MOTION].hypotheses:
        pairs = zip(hypothesis.smallest, hypothesis.largest, strict=True)
        assert all(0.0 < smallest < largest for smallest, largest in pairs), hypothesis.label


def test_only_shapes_in_time_are_bound_to_their_stretch(forwards):
    bound = {h.effect for h in forwards[Mode.MOTION].hypotheses if h.transient}
    assert bound == {"sensor_drift"}
