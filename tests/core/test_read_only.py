"""Frozen values: their arrays cannot be written either."""

import copy
import inspect
import pickle
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import pandas
import pytest

import ves_twin as vt
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.types import FloatArray
from ves_twin.machines.ves2.emulation_cost import EmulationCost
from ves_twin.simulator.build import belief_of, emulated_of

UNRESOLVED = {"EmulationCost": EmulationCost, "pd": pandas, "Figure": object}
"""Names that annotations take from imports for type checkers alone."""


def arrays_of(value: ReadOnly) -> list[np.ndarray]:
    """Every array of a value, also those in its mappings."""
    found = [getattr(value, field.name) for field in fields(value)]
    inner = [item for one in found if isinstance(one, dict) for item in one.values()]
    return [one for one in [*found, *inner] if isinstance(one, np.ndarray)]


@pytest.fixture(scope="module")
def recording() -> Recording:
    values = {"leg.length": np.ones((3, 6))}
    return Recording(np.arange(3.0), values, RecordingInfo("measured"))


def test_a_recording_cannot_be_written(recording):
    for array in arrays_of(recording):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7.0
    for part in (recording.window(0.0, 2.0), replace(recording, info=recording.info)):
        assert len(arrays_of(part)) == 2
        assert not any(array.flags.writeable for array in arrays_of(part))


def parts(hint: object) -> Iterator[Any]:
    """A type and all that stand in it: of a mapping its values, of a union its members."""
    yield hint
    if get_origin(hint) is not Callable:
        for part in get_args(hint):
            yield from parts(part)


def results(public: object) -> Iterator[Any]:
    """What a public function gives; a public class, and what its methods and properties give."""
    if not inspect.isclass(public):
        yield from parts(get_type_hints(public, localns=UNRESOLVED)["return"])
        return
    yield public
    for name, member in vars(public).items():
        member = getattr(member, "__func__", member)
        member = member.fget if isinstance(member, property) else member
        member = member.func if isinstance(member, cached_property) else member
        if inspect.isfunction(member) and not name.startswith("_"):
            yield from parts(get_type_hints(member, localns=UNRESOLVED)["return"])


def within(kind: type) -> dict[str, list[Any]]:
    """Field -> the types that stand in it."""
    hints = get_type_hints(kind, localns=UNRESOLVED)
    return {field.name: list(parts(hints[field.name])) for field in fields(kind)}


def public_values() -> set[type]:
    """Frozen dataclasses that somebody gets from a public name, however deep."""
    found: set[type] = set()
    left = [kind for name in vt.__all__ for kind in results(getattr(vt, name))]
    while left:
        kind = left.pop()
        frozen = is_dataclass(kind) and kind.__dataclass_params__.frozen
        if inspect.isclass(kind) and frozen and kind not in found:
            found.add(kind)
            left += [part for inner in within(kind).values() for part in inner]
    return found


def test_every_public_value_with_arrays_cannot_be_written():
    found = public_values()
    with_arrays = {
        kind
        for kind in found
        if any(get_origin(p) is np.ndarray for inner in within(kind).values() for p in inner)
    }
    assert {"Recording", "Parameter", "Traces", "RigSnapshot"} <= {k.__name__ for k in with_arrays}
    assert not [kind for kind in with_arrays if not issubclass(kind, ReadOnly)]


@dataclass(frozen=True)
class Several(ReadOnly):
    alone: FloatArray
    side_by_side: tuple[FloatArray, ...]
    named: dict[str, FloatArray]


def test_a_copy_and_what_another_process_sends_cannot_be_written_either():
    value = Several(np.zeros(2), (np.zeros(2), np.zeros(2)), {"a": np.zeros(2)})
    for one in (value, copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        every = [one.alone, *one.side_by_side, *one.named.values()]
        assert len(every) == 4
        assert not any(array.flags.writeable for array in every)


def test_what_made_an_array_may_write_it_still():
    time = np.arange(3.0)
    assert not Recording(time, {}, RecordingInfo("measured")).time.flags.writeable
    time[0] = -1.0


def test_what_a_run_rests_on_cannot_be_written():
    """Geometry, belief and beam are shared by everything that is built from them."""
    scenario = vt.Scenario.load("beam_horizontal_truth")
    belief = belief_of(scenario)
    for value in (belief, belief.geometry, emulated_of(scenario)):
        assert arrays_of(value)
        assert not any(array.flags.writeable for array in arrays_of(value))
