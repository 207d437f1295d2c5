"""Any recording comes back from every kind of file as it was."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.recording.recording import Event, Recording, RecordingInfo
from ves_twin.core.recording.stream import STREAM_NAME, RecordingStream
from ves_twin.core.signals import SIGNALS, TIME, Role, Signal
from ves_twin.data.export import FORMATS, export_recording
from ves_twin.data.formats.open_log import open_log

MANY = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

NUMBERS = st.floats(allow_nan=True, allow_infinity=True, width=64)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
"""Any text that can be written as UTF-8."""
NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,6}(\.[a-z_]{1,6})?", fullmatch=True)
UNITS = st.sampled_from(["m", "rad", "N*m", "A", "1", "degC"])


@st.composite
def own_signals(draw):
    width = draw(st.integers(1, 4))
    name = draw(NAMES.filter(lambda name: width > 1 or name != TIME))
    axes = tuple(f"{k + 1}" for k in range(width))
    units = tuple(draw(UNITS) for _ in range(width))
    role = draw(st.sampled_from(list(Role)))
    return Signal(name, axes, units, role, draw(TEXTS), draw(TEXTS))


@st.composite
def recordings(draw, elements=NUMBERS, fewest=1):
    """Signals of the rig in any order beside some of one's own, on any rising clock."""
    own = draw(st.lists(own_signals(), max_size=2, unique_by=lambda s: s.name))
    own = tuple(s for s in own if s.name not in SIGNALS)
    known = draw(st.lists(st.sampled_from(sorted(SIGNALS)), max_size=3, unique=True))
    chosen = [*(SIGNALS[name] for name in known), *own] or [SIGNALS["leg.length"]]
    rows = draw(st.integers(fewest, 12))
    steps = draw(arrays(np.float64, rows, elements=st.floats(1e-6, 10.0)))
    signals = {s.name: draw(arrays(np.float64, (rows, s.width), elements=elements)) for s in chosen}
    info = RecordingInfo(
        origin=draw(st.sampled_from(["measured", "simulated"])),
        scenario=draw(TEXTS),
        seed=draw(st.integers(0, 2**63 - 1)),
        held={name: draw(st.floats(1e-4, 1.0)) for name in known[:1]},
        events=tuple(Event(1.5, draw(TEXTS), draw(TEXTS)) for _ in range(draw(st.integers(0, 2)))),
        own_signals=own,
        versions={"ves_twin": draw(TEXTS)},
    )
    return Recording(np.cumsum(steps) - draw(st.floats(-5.0, 5.0)), signals, info)


def same_bits(one, other):
    """Also the sign of zero; one NaN is as good as another."""
    both = np.isnan(one) & np.isnan(other)
    return one.shape == other.shape and np.array_equal(
        np.where(both, 0.0, one).view(np.int64), np.where(both, 0.0, other).view(np.int64)
    )


def assert_same(found, meant):
    assert list(found.signals) == list(meant.signals)
    assert same_bits(found.time, meant.time)
    for name, values in meant.signals.items():
        assert same_bits(found[name], values), name


def test_no_signal_has_the_column_of_the_times():
    with pytest.raises(InvalidInputError, match=r"name of a signal.*'t'.*is the time"):
        Signal(TIME, ("x",), ("m",), Role.MEASUREMENT, "", "")
    assert Signal(TIME, ("x", "y"), ("m", "m"), Role.MEASUREMENT, "", "").columns == ("t.1", "t.2")


@MANY
@given(out=recordings())
def test_a_recording_is_the_same_after_parquet(out, tmp_path):
    save_recording(out, tmp_path / "r.parquet")
    back = load_recording(tmp_path / "r.parquet")
    assert_same(back, out)
    assert back.info == out.info


@MANY
@given(out=recordings(), cut=st.integers(0, 12))
def test_a_stream_in_pieces_is_the_same_before_and_after_it_is_finished(out, cut, tmp_path):
    pieces = [rows for rows in (slice(0, cut), slice(cut, None)) if len(out.time[rows])]
    stream = RecordingStream(tmp_path, tuple(out.signals), out.info)
    for rows in pieces:
        stream.write(out.time[rows], {name: v[rows] for name, v in out.signals.items()})
    under_way = load_recording(tmp_path / STREAM_NAME)
    finished = load_recording(stream.finish(out.info))
    for back in (under_way, finished):
        assert_same(back, out)
        assert back.info == out.info


FINITE = st.floats(allow_nan=True, allow_infinity=False)
"""Of exports: a lab file's reader takes an infinity for a cell that is no number."""


def test_a_signal_by_the_name_of_the_time_does_not_take_its_place_in_a_mat_file(tmp_path):
    signal = Signal(TIME, ("x", "y"), ("m", "m"), Role.MEASUREMENT, "", "")
    info = RecordingInfo("measured", own_signals=(signal,))
    export_recording(
        Recording(np.arange(3.0), {TIME: np.ones((3, 2))}, info), "mat", tmp_path / "r.mat"
    )
    (table,) = [t for t in open_log(tmp_path / "r.mat").tables if t.name != "units"]
    assert [c.unit for c in table.columns] == ["s", "m", "m"]


@MANY
@given(out=recordings(FINITE, fewest=2), form=st.sampled_from(FORMATS))
def test_what_is_exported_reads_the_same_with_its_units(out, form, tmp_path):
    """By the readers of lab files, which take an exported file as they take anybody's. In MAT a
    single row would be single numbers, which are no channels."""
    path = tmp_path / f"r.{form}"
    export_recording(out, form, path)
    log = open_log(path)
    columns = [c for table in log.tables for c in table.columns if table.name != "units"]
    units = [unit for s in out.signals for unit in out.info.signal(s).units]
    assert [c.unit for c in columns] == ["s", *units]
    found = {}
    for table in log.tables:
        found.update(log.read(table.name, [c.name for c in table.columns]))
    meant = np.column_stack([out.time, *out.signals.values()])
    assert same_bits(np.column_stack([found[c.name] for c in columns]), meant)
