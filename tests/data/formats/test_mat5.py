"""Our reader of MAT files beside scipy's, on the files that scipy tests its own with."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.io.matlab

from ves_twin.data.formats.mat5 import DamagedError, MatKind, mat_variables

DATA = Path(scipy.io.matlab.__file__).parent / "tests" / "data"
FILES = [p for p in sorted(DATA.glob("*.mat")) if p.read_bytes()[:8] == b"MATLAB 5"]


def same(ours, theirs):
    """Whether a value of ours is scipy's."""
    if ours.kind is MatKind.NUMBERS:
        return np.array_equal(ours.numbers, theirs)
    if ours.kind is MatKind.COMPLEX:
        return np.array_equal(ours.numbers, np.real(theirs))
    if ours.kind is MatKind.CELL:
        flat = theirs.reshape(-1, order="F")
        return len(flat) == len(ours.cells) and all(map(same, ours.cells, flat))
    if ours.kind is MatKind.STRUCT:
        flat = theirs.reshape(-1, order="F")
        return all(
            same(one, element[field])
            for row, element in zip(ours.fields, flat, strict=True)
            for field, one in row.items()
        )
    return ours.kind in (MatKind.TEXT, MatKind.SPARSE, MatKind.FUNCTION, MatKind.OBJECT)


@pytest.mark.skipif(len(FILES) < 40, reason="this scipy came without its test files")
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_every_variable_is_what_scipy_reads(path):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            theirs = scipy.io.loadmat(path, struct_as_record=True)
    except Exception:
        theirs = None
    ours = list(mat_variables(path))
    if theirs is None and path.stem == "bad_miutf8_array_name":
        return  # only its name is no text; the numbers are sound
    if theirs is None:  # a damaged file: nothing may be made up
        assert any(isinstance(value, DamagedError) for value in ours)
        return
    for value in ours:
        if not isinstance(value, DamagedError) and value.name and value.name in theirs:
            assert same(value, theirs[value.name]), value.name
    read = {value.name for value in ours if not isinstance(value, DamagedError)}
    assert {name for name in theirs if not name.startswith("__")} - {"None"} <= read


def test_texts_are_read(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"s": "Winkel in °", "c": np.array(["a", "b"], object)})
    text, cell = mat_variables(tmp_path / "a.mat")
    assert text.text == "Winkel in °"
    assert [one.text for one in cell.cells] == ["a", "b"]
