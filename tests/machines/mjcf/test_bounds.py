"""Bounds of parameters, and runs that no machine can make."""

from __future__ import annotations

import numpy as np
import pytest
from two_link import programme, rig, write_files

from ves_twin.core.errors import VesTwinError
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

FED = programme()


@pytest.fixture(scope="module")
def forwards(tmp_path_factory):
    machine = rig(tmp_path_factory.mktemp("rig"))
    return {mode: MjcfForward.of(machine, mode) for mode in Mode}


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
    """An arm of 0.8 kg that may be off by 6 kg is no arm of -5.2 kg."""
    forward = MjcfForward.of(rig(tmp_path, more=LARGE))
    found = {p.name: p for p in forward.parameters}
    mass, share = found["body_mass@arm:mass"], found["body_inertia@cart:share"]
    assert (mass.low, mass.high) == pytest.approx((0.008, 6.8))
    assert (share.low, share.high) == pytest.approx((-0.99, 3.0))
    frictions = ("viscous_friction", "coulomb_friction")
    assert all(p.low >= 0.0 for p in forward.parameters if p.name.startswith(frictions))
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
    found = forwards[mode].simulate(FED, {"body_mass@arm:mass": -1.5, **more})
    assert np.isnan(found).all()


def test_a_steady_effort_is_the_same_in_mujocos_own_loop_and_in_ours(tmp_path):
    """Friction that differs by direction needs our loop; at a size next to nothing it is none."""
    forward = MjcfForward.of(rig(tmp_path))
    pushed = {"force_offset@rail:offset": 2.0, "force_offset@swing:offset": -0.1}
    inside = forward.simulate(programme(), pushed)
    outside = forward.simulate(programme(), pushed | {"viscous_asymmetry@rail:slope": 1e-12})
    # to the rounding that a second of motion makes of it
    assert np.abs(inside - outside)[:500].max() < 1e-6
    assert np.abs(inside - forward.simulate(programme(), {})).max() > 1e-2


def test_one_computer_reads_all_signals_of_a_part_late(tmp_path):
    more = '\n[[effects]]\nkind = "sensor_delay"\non = ["cart"]\nlow = "-1 ms"\nsd = "0.1 ms"\n'
    forward = MjcfForward.of(rig(tmp_path, more=more))
    plain = forward.simulate(programme(), {})
    late = forward.simulate(programme(), {"sensor_delay@cart:delay": 0.004})
    names = [c.signal for c in forward.channels]
    for i, name in enumerate(names):
        whole = name.startswith("cart.")
        expected = (
            np.concatenate([plain[:1, i], plain[:1, i], plain[:-2, i]]) if whole else plain[:, i]
        )
        assert late[:, i] == pytest.approx(expected, abs=1e-12), name
    (delay,) = [p for p in forward.parameters if p.name == "sensor_delay@cart:delay"]
    assert (delay.low, delay.sd) == (-0.001, 0.0001)
