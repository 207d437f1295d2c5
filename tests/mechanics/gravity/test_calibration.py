"""Calibration files: what is written is read back, and what does not fit is refused."""

import numpy as np
import pytest

from ves_twin.core.errors import (
    FileAccessError,
    InvalidInputError,
    UnknownNameError,
    VersionError,
    VesTwinError,
)
from ves_twin.mechanics.gravity.calibration import GravityCalibration
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.identify import identify
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint


@pytest.fixture
def calibration(bench):
    rng = np.random.default_rng(20)
    observations = bench.readings(rng, *bench.poses(rng, 47))
    found = identify(observations, bench.model.basis, bench.position, 9.81, bench.full_scale, None)
    return GravityCalibration.of(found, "sensor-1", 'a "quoted" source')


@pytest.fixture
def path(calibration, tmp_path):
    calibration.save(tmp_path / "gravity.toml")
    return tmp_path / "gravity.toml"


def test_a_file_reads_back_to_the_last_bit(calibration, path):
    read = GravityCalibration.load(str(path))
    for name in ("matrix", "zero", "moments", "half_width"):
        np.testing.assert_array_equal(getattr(read, name), getattr(calibration, name))
    assert read.total_mass == calibration.total_mass
    assert read.source == calibration.source
    assert list(path.parent.iterdir()) == [path]  # nothing half written is left


def test_another_sensor_is_refused(calibration, bench):
    calibration.check("sensor-1", bench.model.basis)
    with pytest.raises(InvalidInputError, match=r"sensor-1.*sensor-2"):
        calibration.check("sensor-2", bench.model.basis)


def test_another_arm_is_refused(calibration):
    other = FirstMoments.of(DhChain((Joint(0.5, 0.3, 0.0),), np.eye(4)))
    with pytest.raises(InvalidInputError, match="arm"):
        calibration.check("sensor-1", other)


@pytest.mark.parametrize(
    ("old", "new", "error"),
    [
        ("schema = 1", "schema = 9", VersionError),
        ("[arm]", "[leg]", UnknownNameError),
        ("total_mass = ", "total_mass = 'heavy' #", InvalidInputError),
        ("zero = [", "zero = [1.0, ", InvalidInputError),
        ("half_width = [", "half_width = [nan, ", InvalidInputError),
        ("[model]", "model = 3\n[x]", VesTwinError),
        ("schema = 1", "schema 1", InvalidInputError),
    ],
)
def test_a_broken_file_is_refused_in_one_line(path, old, new, error):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(error) as caught:
        GravityCalibration.load(str(path))
    assert "\n" not in str(caught.value)


def test_a_matrix_that_cannot_be_inverted_is_refused(path):
    read = GravityCalibration.load(str(path))
    text = path.read_text()
    for row in read.matrix:
        text = text.replace(f"[{', '.join(repr(float(v)) for v in row)}],", "[1, 1, 1, 1, 1, 1],")
    path.write_text(text)
    with pytest.raises(InvalidInputError, match="singular"):
        GravityCalibration.load(str(path))


def test_a_missing_file_is_refused():
    with pytest.raises(FileAccessError):
        GravityCalibration.load("nowhere/gravity.toml")
    with pytest.raises(UnknownNameError, match="ves2_47_poses"):
        GravityCalibration.load("ves2_47_pose")
