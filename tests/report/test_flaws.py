"""Flaws of recordings stand on the terminal, too, the first of each sort first."""

from ves_twin.data.quality.check import failed
from ves_twin.report.diagnosis.flaws import FLAWS, RESTS, flaw_lines, flaws

GAPS = [failed("gaps", f"gap {n}") for n in range(FLAWS + 3)]


def test_the_first_of_each_sort_are_told_before_the_others():
    first, more = flaws([*GAPS, failed("rate", "20 s apart")])
    assert first == ["gap 0", "gap 1", "20 s apart"]
    assert more == ["gap 2", "gap 3", "gap 4"]


def test_a_terminal_has_a_line_for_each_and_counts_the_others():
    assert flaw_lines(GAPS) == [RESTS, "  gap 0", "  gap 1", "  3 more like these"]
    assert flaw_lines(GAPS[:1]) == [RESTS, "  gap 0"]
    assert flaw_lines([]) == []
