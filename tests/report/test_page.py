"""Parts of a page: escaping, tables, numbers, figures with names of their own."""

import re

import numpy as np
import pytest

from ves_twin.core.quantity import percent, quantity
from ves_twin.report.diagnosis.words import listed
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html, bullets, markup, paragraph, table
from ves_twin.report.page import html_page
from ves_twin.report.plots import Trace, draw_cells, draw_change, draw_levels, draw_traces, thinned


def test_text_is_escaped_once_and_html_is_not():
    assert markup("<a> & b") == "&lt;a&gt; &amp; b"
    assert paragraph(markup("<a>")) == "<p>&lt;a&gt;</p>"
    assert "&lt;x&gt;" in bullets(["<x>"])
    assert bullets([]) == ""


def test_numbers_of_a_table_stand_to_the_right():
    text = table(("what", "size, m"), [("leg <1>", "0.31 mm"), ("leg 2", "-")])
    assert "<td>leg &lt;1&gt;</td>" in text
    assert '<td class="number">0.31 mm</td>' in text
    assert "<td>-</td>" in text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (3.1e-4, "m", "310 um"),
        (-2.04, "N*m", "-2.04 N m"),
        (1500.0, "N", "1500 N"),
        (2.03e4, "Pa", "20.3 kPa"),
        (0.0, "rad", "0 rad"),
        (0.0123, "1", "0.0123"),
        (float("nan"), "m", "-"),
        (None, "m", "-"),
    ],
)
def test_numbers_read_with_a_prefix(value, unit, text):
    assert quantity(value, unit) == text


def test_more_digits_come_where_they_are_asked_for():
    assert quantity(1.19735, "N", 5) == "1.1973 N"
    assert quantity(1.19735, "N") == "1.2 N"


def test_shares_have_two_digits():
    assert percent(0.01234) == "1.2 %"
    assert percent(None) == "-"


def test_figures_of_a_page_share_no_id_and_load_nothing():
    first = draw_levels(["a", "b"], [0.1, 20.0], "sigma", 1.0)
    second = draw_cells(["a", "b"], ["x"], np.array([[1.0], [np.nan]]), "band")
    third = new_figure(2.0)
    draw_traces(third.add_subplot(), np.arange(9.0), [Trace("y", np.arange(9.0), "k")], "m", 2.0)
    parts = [
        svg(figure, f"f{k}", 'a "caption" <i>') for k, figure in enumerate((first, second, third))
    ]
    page = html_page("<title>", parts)
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    used = set(re.findall(r"url\(#([^)]*)\)", page)) | set(re.findall(r'href="#([^"]*)"', page))
    assert used <= set(ids)
    assert isinstance(parts[0], Html)
    assert not re.search(r'(?:src|href)="(?!#)', page)
    assert "&lt;title&gt;" in page


def test_a_long_line_keeps_its_peaks():
    values = np.zeros(100_000)
    values[54_321] = 7.0
    time, drawn = thinned(np.arange(100_000.0), values)
    assert len(drawn) <= 1400
    assert drawn.max() == 7.0
    assert np.all(np.diff(time) >= 0)


def test_an_option_is_not_broken_at_its_dashes_and_what_is_html_stays():
    held = markup("give it as --held-out. -- or a-b, <x>")
    assert held == 'give it as <span class="whole">--held-out</span>. -- or a-b, &lt;x&gt;'
    assert markup(held) == held


def test_levels_are_read_off_an_axis_of_plain_numbers():
    figure = draw_change(["a", "b"], [1.25, 0.2], [0.98, 0.16], "sigma", 1.0)
    figure.canvas.draw()
    ticks = [tick.get_text() for tick in figure.axes[0].get_xticklabels(which="both")]
    assert {"0.2", "0.5", "1"} <= set(ticks)
    assert not [text for text in ticks if "10" in text and "^" in text]


def test_names_are_listed_as_a_person_says_them():
    assert listed(["a"]) == "a"
    assert listed(["a", "b"]) == "a and b"
    assert listed(["a", "b", "c"]) == "a, b and c"
