"""Laws that every kind of effect keeps that any machine of an MJCF model can have."""

from dataclasses import replace

import numpy as np
import pytest
import servo_rig
import two_link
from two_link import TARGETS, write_files

from ves_twin.effects.element import Element
from ves_twin.effects.registry import EFFECTS, RENAMED_ANYWHERE, build_anywhere
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

ANYWHERE = [kind for kind in EFFECTS if EFFECTS[kind].anywhere]

RIGS = {two_link: Mode, servo_rig: (Mode.CONTROL,)}
"""Rigs that have a place for every kind, and the modes in which they are tried."""


@pytest.fixture(scope="module", params=RIGS, ids=lambda one: one.__name__)
def tried(request, tmp_path_factory):
    machine = request.param.rig(tmp_path_factory.mktemp("rig"))
    forwards = {mode: MjcfForward.of(machine, mode) for mode in RIGS[request.param]}
    return request.param.programme(), forwards, set(request.param.TARGETS)


def test_every_kind_that_any_machine_can_have_is_tried_here():
    targets = {kind for one in RIGS for kind in one.TARGETS}
    assert targets == set(ANYWHERE) & set(EFFECTS.built_in)


def test_nominal_values_change_nothing_to_the_last_bit(tried):
    fed, forwards, _ = tried
    for forward in forwards.values():
        told = forward.simulate(fed, {p.name: p.nominal for p in forward.parameters})
        assert np.array_equal(told, forward.simulate(fed, {}))
        assert np.all(np.isfinite(told))


def test_every_parameter_moves_a_signal_in_some_mode(tried):
    fed, forwards, kinds = tried
    moving, every = set(), set()
    for forward in forwards.values():
        sd = np.array([c.sd for c in forward.channels])
        starts = {
            name: dict(zip(h.parameters, start, strict=True))
            for h in forward.hypotheses
            for start in h.starts[:1]
            for name in h.parameters
        }
        plain = forward.simulate(fed, {})
        for p in forward.parameters:
            # a gap says nothing where the friction behind it has no level
            others = starts.get(p.name, {})
            values = others | {p.name: p.nominal + 0.2 * (p.high - p.nominal)}
            change = forward.simulate(fed, values)
            change = change - (forward.simulate(fed, others) if others else plain)
            every.add(p.name)
            if np.max(np.abs(change) / sd) > 1.0:
                moving.add(p.name)
    swings_in_the_plane = {"payload@arm:y"} if "payload" in kinds else set()
    assert every - moving == swings_in_the_plane


def test_the_smallest_size_of_interest_is_below_the_largest_and_both_are_positive(tried):
    _, forwards, _ = tried
    for hypothesis in next(iter(forwards.values())).hypotheses:
        pairs = zip(hypothesis.smallest, hypothesis.largest, strict=True)
        assert all(0.0 < smallest < largest for smallest, largest in pairs), hypothesis.label


def test_only_shapes_in_time_are_bound_to_their_stretch(tried):
    _, forwards, kinds = tried
    bound = {h.effect for h in next(iter(forwards.values())).hypotheses if h.transient}
    assert bound == {"sensor_wander"} & kinds


@pytest.mark.parametrize("earlier", RENAMED_ANYWHERE)
def test_an_earlier_name_in_the_file_of_a_machine_is_the_kind_of_today(earlier, tmp_path):
    kind = RENAMED_ANYWHERE[earlier]
    assert build_anywhere(earlier, "x.1", {}).kind == kind
    targets = {earlier: TARGETS[kind]}
    present = f'\n[present.{earlier}."{TARGETS[kind][0]}"]\np1 = 0.5\n'
    path = write_files(tmp_path, more=present, kinds=targets)
    (entry,) = (e for e in Rig.load(str(path)).entries if e.effect.kind == kind)
    assert entry.cause
    assert entry.nominal[0] == 0.5


@pytest.mark.parametrize(
    "kind", [k for k in TARGETS if EFFECTS[k].anywhere.element is Element.SIGNAL]
)
def test_what_a_sensor_saw_comes_back_from_what_it_read(kind, tmp_path):
    """To second order in the smallest size of interest; ends are held within the delay of them."""
    entry = next(
        e
        for e in two_link.rig(tmp_path).entries
        if (e.effect.kind, e.effect.target) == (kind, TARGETS[kind][0])
    )
    size = entry.magnitudes[0].smallest
    effect = replace(entry.effect, **{next(iter(entry.effect.values)): size})
    time = 0.002 * np.arange(500)
    true = np.sin(np.outer(time, [7.0, 5.0, 3.0])) + 0.2
    read = effect.edit_reading(true, true, time, entry.place)
    back = effect.undo_reading(read, time, entry.place)
    inner = slice(10, -10)
    off = np.max(np.abs(read - true)[inner])
    assert off > 0.0
    assert np.max(np.abs(back - true)[inner]) < 0.1 * off
