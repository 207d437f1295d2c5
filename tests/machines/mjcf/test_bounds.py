"""Bounds of parameters, and runs that no machine can make."""

from __future__ import annotations

import numpy as np
import pytest
from two_link import programme, rig, write_files

from ves_twin.core.errors import VesTwinError
from ves_twin.machines.mjcf.description import Mode
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig

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
    """An arm of 1 kg that may be off by 6 kg is no arm of -5 kg."""
    forward = MjcfForward.of(rig(tmp_path, more=LARGE))
    found = {p.name: p for p in forward.parameters}
    mass, share = found["body_mass@arm:mass"], found["body_inertia@cart:share"]
    assert (mass.low, mass.high) == pytest.approx((0.01, 7.0))
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
    found = forwards[mode].simulate(FED, {"body_mass@arm:mass": -0.5, **more})
    assert np.isnan(found).all()
