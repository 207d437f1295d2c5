"""Tolerances: limits in SI by signal or column, and bad files answered in one line."""

import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.machines.machine import Machine
from ves_twin.machines.tolerance import Tolerance

SIGNALS = Machine.load("ves2").signals


def write(tmp_path, text):
    path = tmp_path / "limits.toml"
    path.write_text(f"schema = 1\n{text}")
    return path


def test_a_signal_gives_its_limit_to_every_column(tmp_path):
    text = '[rms]\nleg.length = "0.2 mm"\n"arm.q.2" = 1e-3\n[peak]\nsensor.wrench = "2 N"\n'
    limits = Tolerance.load(write(tmp_path, text), SIGNALS).limits
    assert limits["rms"] == pytest.approx(
        {**{f"leg.length.{i}": 2e-4 for i in range(1, 7)}, "arm.q.2": 1e-3}
    )
    assert limits["peak"] == {f"sensor.wrench.{i}": 2.0 for i in (1, 2, 3)}


def test_a_column_that_was_not_compared_keeps_no_limit(tmp_path):
    tolerance = Tolerance.load(write(tmp_path, '[rms]\n"arm.q.2" = "1 mrad"\n'), SIGNALS)
    (excess,) = tolerance.excesses("run", ())
    assert (excess.channel, excess.found, excess.limit) == ("arm.q.2", None, 1e-3)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[rms]\nleg.lenght = 1\n", "did you mean 'leg.length'"),
        ("[mrs]\nleg.length = 1\n", "did you mean 'rms'"),
        ('[rms]\nleg.length = "1 N"\n', "quantity in m"),
        ("[rms]\nsensor.wrench = 1\n", "N or N"),
        ("[rms]\nleg.length = 0\n", "above zero"),
        ("[rms]\nleg.length = [1, 2]\n", "6 limits"),
        ("", "at least one"),
    ],
)
def test_a_bad_limit_gets_one_line(tmp_path, text, says):
    with pytest.raises(VesTwinError, match=says):
        Tolerance.load(write(tmp_path, text), SIGNALS)
