"""MAT and NumPy files: arrays, structs, and objects that are named and never opened."""

import pickle
import warnings

import numpy as np
import pytest
import scipy.io
from opaque import opaque_mat

from ves_twin.core.errors import VesTwinError
from ves_twin.data.formats.open_log import open_log

T = np.arange(200) * 0.005


def full(log):
    return list(log.full_names())


def test_arrays_and_structs_become_tables(tmp_path):
    daq = {"Time": T, "F": np.outer(T, [1.0, 2.0, 3.0]), "gain": 4.0}
    slow = {"t": T[:50], "p": 2.0 * T[:50]}
    path = tmp_path / "lab.mat"
    scipy.io.savemat(path, {"t": T, "q": np.outer([1.0, -1.0], T), "daq": daq, "plc": slow})
    log = open_log(path)
    assert full(log) == [
        *("t", "q.1", "q.2"),
        *("daq.Time", "daq.F.1", "daq.F.2", "daq.F.3", "plc.t", "plc.p"),
    ]
    assert np.array_equal(log.read("", ["q.2"])["q.2"], -T)
    assert np.array_equal(log.read("daq", ["F.3"])["F.3"], 3.0 * T)
    assert any("daq.gain" in fault for fault in log.faults)


def test_arrays_of_two_lengths_come_as_two_tables(tmp_path):
    scipy.io.savemat(tmp_path / "lab.mat", {"t": T, "x": T, "y": T, "t2": T[:20], "z": T[:20]})
    log = open_log(tmp_path / "lab.mat")
    assert [(t.name, t.rows) for t in log.tables] == [("", 200), ("rows_20", 20)]
    assert "rows_20.z" in full(log)


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        ("timetable", "timetable2table(log1)"),
        ("timeseries", "log1.Data"),
        ("string", "cellstr(log1)"),
        ("MyClass", "struct(log1)"),
    ],
)
def test_an_object_is_named_with_the_line_that_converts_it(tmp_path, kind, line):
    opaque_mat(tmp_path / "lab.mat", "log1", kind)
    log = open_log(tmp_path / "lab.mat")
    assert np.array_equal(log.read("", ["t"])["t"], np.arange(8.0))
    (fault,) = log.faults
    assert fault.startswith(f"log1: a MATLAB {kind}")
    assert line in fault


def test_functions_complex_numbers_and_mixed_cells_are_named(tmp_path):
    cells = np.empty(2, dtype=object)
    cells[:] = [T, "text"]
    scipy.io.savemat(tmp_path / "lab.mat", {"t": T, "z": T * 1j, "c": cells})
    faults = " | ".join(open_log(tmp_path / "lab.mat").faults)
    assert "z: complex" in faults
    assert "c: a cell array" in faults


def test_version_7_3_names_the_line_that_saves_it_anew(tmp_path):
    head = b"MATLAB 7.3 MAT-file, HDF5".ljust(512) + b"\x89HDF\r\n\x1a\n" + b"\0" * 64
    (tmp_path / "lab.mat").write_bytes(head)
    with pytest.raises(VesTwinError, match=r"save\('lab_v7.mat', '-v7'\)"):
        open_log(tmp_path / "lab.mat")


@pytest.mark.parametrize("compressed", [False, True])
def test_a_mat_file_that_was_cut_keeps_its_whole_variables(tmp_path, compressed):
    path = tmp_path / "lab.mat"
    scipy.io.savemat(path, {"t": T, "x": 2 * T, "y": 3 * T}, do_compression=compressed)
    path.write_bytes(path.read_bytes()[:-100])
    log = open_log(path)
    assert full(log) == ["t", "x"]
    assert any("variable 3: cut or damaged" in fault for fault in log.faults)


def test_npz_arrays_are_read_and_objects_in_it_named(tmp_path):
    path = tmp_path / "lab.npz"
    np.savez(path, t=T, q=np.outer(T, [1, 2]), o=np.array([{}], dtype=object))
    log = open_log(path)
    assert full(log) == ["t", "q.1", "q.2"]
    assert any("o: a pickle" in fault for fault in log.faults)
    rows = np.zeros(5, dtype=[("t", float), ("x", int)])
    np.save(tmp_path / "lab.npy", rows)
    assert full(open_log(tmp_path / "lab.npy")) == ["lab.t", "lab.x"]


class Bomb:
    """What a hostile pickle does: anything."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def test_a_signalling_nan_of_single_precision_is_a_hole_without_a_warning(tmp_path):
    path = tmp_path / "lab.npz"
    x = np.array([0x3F800000, 0x7FA00000, 0x40000000], np.uint32).view(np.float32)
    np.savez(path, t=np.arange(3.0), x=x)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (block,) = open_log(path).blocks("", ["x"])
    assert np.array_equal(block["x"], [1.0, np.nan, 2.0], equal_nan=True)


@pytest.mark.parametrize("name", ["bomb.pkl", "bomb.csv", "bomb.npy", "bomb.npz", "bomb.mat"])
def test_no_code_in_a_file_is_ever_run(tmp_path, name):
    mark = tmp_path / "executed"
    objects = np.empty(1, dtype=object)
    objects[0] = Bomb(mark)
    path = tmp_path / name
    if name.endswith("npz"):
        np.savez(path, o=objects)
    elif name.endswith("npy"):
        np.save(path, objects)
    else:
        path.write_bytes(pickle.dumps(Bomb(mark)))
    with pytest.raises(VesTwinError, match="pickle: reading it can run code"):
        open_log(path)
    assert not mark.exists()


@pytest.mark.parametrize(
    ("content", "name", "says"),
    [
        (b"", "a.csv", "0 bytes"),
        (b"#ROSBAG V2.0\n", "a.bag", "mcap convert"),
        (b"SQLite format 3\0", "a.db3", "ros2 bag convert"),
        (b"RRF2", "a.rrd", "rerun file"),
        (b"\x89HDF\r\n\x1a\n", "a.h5", "HDF5"),
        (b"PK\x03\x04garbage", "a.npz", "damaged archive"),
        (b"\x93NUMPY\x01", "a.npy", "damaged"),
        (b"MATLAB 5.0 MAT-file".ljust(126) + b"IM", "a.mat", "0 variables"),
    ],
)
def test_what_cannot_be_read_gets_one_line(tmp_path, content, name, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(VesTwinError, match=says) as caught:
        open_log(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_an_empty_folder_get_one_line(tmp_path):
    with pytest.raises(VesTwinError, match="No such file"):
        open_log(tmp_path / "no.csv")
    with pytest.raises(VesTwinError, match="holds no recording"):
        open_log(tmp_path)
