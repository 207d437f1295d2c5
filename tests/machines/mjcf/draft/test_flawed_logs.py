"""Logs with gaps, dropouts or too few rows, and a model that is too light: what a draft does."""

from __future__ import annotations

import re

import numpy as np
import pytest
from drafted import changed, drafted
from three_joints import ARM

from ves_twin.core.errors import InvalidInputError


def test_rows_that_are_missing_altogether_break_a_log_and_the_longest_stretch_is_used(
    arm, columns, write
):
    """A log that a clock's gap broke was refused, by a key of a file that was not there yet."""
    kept = np.r_[0:200, 206 : len(columns["t"])]
    found, rig = drafted(arm, write({name: rows[kept] for name, rows in columns.items()}))
    assert rig.description.window.start == pytest.approx(columns["t"][206] - columns["t"][0])
    assert any("without rows or numbers" in words for words in found.look)


def test_a_log_that_is_too_short_for_a_diagnosis_is_told(arm, columns, write):
    found, _ = drafted(arm, write({name: rows[:90] for name, rows in columns.items()}))
    assert any("too short for a diagnosis" in words for words in found.look)


def test_the_stretches_that_are_advised_are_two_at_least(arm, columns, write):
    time = columns["t"] - columns["t"][0]
    long = {name: rows[time <= 3.0 + 1e-9] for name, rows in columns.items()}
    found, _ = drafted(arm, write(long))
    assert found.stretch == 0.0 or 1.5 * found.stretch < 3.0


@pytest.mark.parametrize(("rows", "stretch"), [(401, 1.0), (601, 1.5), (1401, 2.0)])
def test_a_short_log_is_cut_into_four_stretches_that_are_alike(swing, write, rows, stretch):
    path, columns = swing
    log = write({name: values[:rows] for name, values in columns.items()})
    assert drafted(path, log)[0].stretch == stretch


def test_a_position_that_drops_out_is_told_first(arm, columns, write):
    q2 = columns["q2"].copy()
    q2[300:307] = 9.0
    found, _ = drafted(arm, write(changed(columns, q2=q2)))
    said = next(words for words in found.look if "q2 jumps to 9 and back" in words)
    assert "for 7 rows in all" in said
    assert all("wrong sign" not in words for words in found.look[: found.look.index(said)])


def test_a_link_that_is_half_as_heavy_in_the_model_gets_a_range_that_holds_it(
    tmp_path, columns, write
):
    """By half of its mass at most a link of twice its mass was named as a delay."""
    arm = tmp_path / "light.xml"
    arm.write_text(re.sub(r'mass="([0-9.]+)"', lambda m: f'mass="{0.5 * float(m[1]):g}"', ARM))
    _, rig = drafted(arm, write(columns))
    heavy = [e for e in rig.description.effects if e.kind == "body_mass"]
    assert heavy
    for entry in rig.entries:
        if entry.effect.kind == "body_mass" and entry.effect.target in heavy[0].on:
            told = float(rig.model.body(entry.effect.target).mass[0])
            assert entry.magnitudes[0].high >= 1.0 * told, entry.effect.target


def test_bodies_without_a_name_or_a_mass_of_their_own_get_no_range(tmp_path, columns, write):
    light = re.sub(r'mass="([0-9.]+)"', lambda m: f'mass="{0.5 * float(m[1]):g}"', ARM)
    arm = tmp_path / "bare.xml"
    arm.write_text(re.sub(r'<body name="\w+"', "<body", light))
    found, _ = drafted(arm, write(columns))
    assert "body_mass" not in found.text


def test_rows_that_come_in_pairs_are_no_gaps(arm, columns, write):
    pairs = np.arange(len(columns["t"])) % 8 < 2
    found, rig = drafted(arm, write({name: rows[pairs] for name, rows in columns.items()}))
    assert rig.description.window.start == 0.0
    assert any("uneven" in words for words in found.look)


def test_signals_of_several_clocks_are_refused_with_what_to_do(arm, columns, write):
    """Messages of a bus, a row each, as a player exports them."""
    names = [name for name in columns if name != "t"]
    rows = np.full((len(columns["t"]), len(names)), np.nan)
    for k in range(len(rows)):
        rows[k, k % len(names)] = columns[names[k % len(names)]][k]
    log = write({"t": columns["t"]} | dict(zip(names, rows.T, strict=True)))
    log.write_text(log.read_text().replace("nan", ""))
    with pytest.raises(
        InvalidInputError, match=r"no row holds all of them: signals of several .* import --map"
    ):
        drafted(arm, log)
