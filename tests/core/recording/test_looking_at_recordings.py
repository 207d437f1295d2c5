"""Looking at a recording: its repr, as a DataFrame, as a figure."""

import sys
from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError


def test_repr_names_origin_length_and_units_in_ten_lines_at_most(beam_short):
    lines = repr(beam_short).split("\n")
    assert len(lines) <= 10
    assert "simulated beam_horizontal_truth" in lines[0]
    assert f"{len(beam_short)} rows" in lines[0]
    assert any("leg.length" in line and "6 x [m]" in line for line in lines)
    assert f"and {len(beam_short.signals) - 6} more" in lines[-1]


def test_repr_of_an_empty_recording_says_so(beam_short):
    empty = beam_short.window(1e6, 2e6)
    assert "0 rows, empty" in repr(empty)


def test_a_data_frame_holds_every_column_by_its_name_in_files(beam_short):
    frame = beam_short.to_pandas()
    assert frame.index.name == "t"
    np.testing.assert_array_equal(frame.index, beam_short.time)
    for name, values in beam_short.signals.items():
        columns = list(beam_short.info.signal(name).columns)
        np.testing.assert_array_equal(frame[columns].to_numpy(), values)
    assert frame.attrs["units"]["sensor.wrench.4"] == "N*m"
    assert set(frame.attrs["units"]) == set(frame.columns)


def test_a_recording_without_signals_is_a_frame_without_columns(beam_short):
    assert replace(beam_short, signals={}).to_pandas().shape == (len(beam_short), 0)


def test_without_pandas_one_line_names_the_extra(beam_short, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(VesTwinError, match=r"pip install 'ves_twin\[pandas\]'"):
        beam_short.to_pandas()


def test_a_figure_has_a_panel_for_each_unit_of_each_signal(beam_short):
    axes = beam_short.plot("leg.length", "sensor.wrench").axes
    labels = [axis.get_ylabel() for axis in axes]
    assert labels == ["leg.length [m]", "sensor.wrench [N]", "sensor.wrench [N*m]"]
    assert [len(axis.lines) for axis in axes] == [6, 3, 3]
    drawn = axes[2].lines[0].get_ydata()
    np.testing.assert_array_equal(drawn, beam_short["sensor.wrench"][:, 3])


def test_without_names_the_first_signals_are_drawn(beam_short):
    first = next(iter(beam_short.signals))
    assert beam_short.plot().axes[0].get_ylabel().startswith(first)


def test_a_signal_that_is_not_there_is_refused_with_the_nearest(beam_short):
    with pytest.raises(UnknownNameError, match=r"leg\.length"):
        beam_short.plot("leg.lenght")
    with pytest.raises(InvalidInputError, match="panels"):
        beam_short.plot(*(["sensor.wrench"] * 7))


def test_tab_completion_lists_what_a_user_needs():
    assert set(vt.__all__) <= set(dir(vt))
    assert "effects" in dir(vt)
    assert not [name for name in dir(vt) if name.startswith("_") and name != "__version__"]
