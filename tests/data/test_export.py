"""export: what is written for other programs comes back to the last bit, with its units."""

import json
from errno import ENOSPC

import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ves_twin.core.errors import FileAccessError, UnknownNameError
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.signals import Role, Signal
from ves_twin.data.draft_map import draft_map
from ves_twin.data.export import export_recording
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.inspect_log import inspect_log
from ves_twin.data.mapping.import_map import ImportMap

OWN = Signal("motor.current", ("a", "b"), ("A", "A"), Role.MEASUREMENT, "motor", "")
NUMBERS = st.floats(allow_nan=True, allow_infinity=False, width=64, allow_subnormal=False)


def recording(values, time=None):
    time = np.arange(len(values)) * 0.1 if time is None else time
    signals = {"arm.q": values[:, :3], "supply.pressure": values[:, 3:4], OWN.name: values[:, 4:6]}
    return Recording(time, signals, RecordingInfo("measured", own_signals=(OWN,)))


@pytest.mark.parametrize("form", ["csv", "mat", "parquet"])
@given(values=arrays(np.float64, (7, 6), elements=NUMBERS))
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_numbers_come_back_to_the_last_bit(form, values, tmp_path_factory):
    path = tmp_path_factory.mktemp("export") / f"rec.{form}"
    out = recording(values)
    export_recording(out, form, path)
    log = open_log(path)
    (table,) = [t for t in log.tables if t.rows in (7, None)]
    names = [c.name for c in table.columns]
    found = log.read(table.name, names)
    assert np.array_equal(found[names[0]], out.time)
    assert np.array_equal(np.column_stack([found[n] for n in names[1:]]), values, equal_nan=True)
    assert [c.unit for c in table.columns] == ["s", "rad", "rad", "rad", "Pa", "A", "A"]


@pytest.mark.parametrize("form", ["csv", "mat"])
def test_an_exported_recording_is_imported_by_its_drafted_map(form, tmp_path):
    rng = np.random.default_rng(0)
    time = np.cumsum(rng.uniform(0.01, 0.012, 50))
    out = recording(rng.normal(size=(50, 6)), time - time[0])
    path = tmp_path / f"rec.{form}"
    export_recording(out, form, path)
    (tmp_path / "m.toml").write_text(draft_map(inspect_log(open_log(path))))
    back = import_log(open_log(path), ImportMap.load(tmp_path / "m.toml")).recording
    assert np.array_equal(back.time, out.time)
    assert np.array_equal(back["arm.q"], out["arm.q"])
    assert np.array_equal(back["supply.pressure"], out["supply.pressure"])


def test_csv_has_one_header_line_and_a_sidecar_with_the_rest(tmp_path):
    files = export_recording(recording(np.ones((3, 6))), "csv", tmp_path / "r.csv")
    head = (tmp_path / "r.csv").read_text().splitlines()[0]
    assert head.startswith("t [s],arm.q.1 [rad],")
    content = json.loads(files[1].read_text())
    assert content["columns"]["motor.current.2"] == {
        **{"signal": "motor.current", "axis": "b", "unit": "A"},
        **{"frame": "motor", "role": "measurement", "meaning": ""},
    }
    assert content["info"]["origin"] == "measured"


def test_mat_is_what_matlab_users_expect(tmp_path):
    export_recording(recording(np.ones((3, 6))), "mat", tmp_path / "r.mat")
    content = scipy.io.loadmat(tmp_path / "r.mat", simplify_cells=True)
    assert content["arm_q"].shape == (3, 3)
    assert content["units"]["arm_q_2"] == "rad"
    assert json.loads(content["ves_twin"])["info"]["origin"] == "measured"


def test_parquet_is_a_recording_of_ours(tmp_path):
    export_recording(recording(np.ones((3, 6))), "parquet", tmp_path / "r.parquet")
    assert load_recording(tmp_path / "r.parquet").info.signal(OWN.name) == OWN


def test_an_unknown_format_and_a_missing_folder_leave_nothing_behind(tmp_path):
    with pytest.raises(UnknownNameError, match="did you mean 'csv'"):
        export_recording(recording(np.ones((3, 6))), "csvv", tmp_path / "r.csv")
    for form in ("csv", "mat", "parquet"):
        with pytest.raises(FileAccessError):
            export_recording(recording(np.ones((3, 6))), form, tmp_path / "no" / "r.x")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("form", ["csv", "mat"])
def test_an_export_on_a_full_disk_leaves_nothing_behind(tmp_path, monkeypatch, form):
    def fill(*arguments, **options):
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr("pyarrow.csv.write_csv", fill)
    monkeypatch.setattr("scipy.io.savemat", fill)
    with pytest.raises(FileAccessError, match="No space left"):
        export_recording(recording(np.ones((3, 6))), form, tmp_path / "a")
    assert not list(tmp_path.iterdir())
