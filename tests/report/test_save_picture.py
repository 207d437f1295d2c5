"""Pictures are whole files."""

from errno import ENOSPC

import matplotlib.image
import pytest
from matplotlib.figure import Figure

from ves_twin.core.errors import FileAccessError
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture


def test_a_picture_has_its_size_in_inches_times_its_resolution(tmp_path):
    path = save_picture(new_figure(2.0, 3.0), tmp_path / "a.png", 100)
    assert matplotlib.image.imread(path).shape[:2] == (200, 300)
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_leaves_the_picture_that_was_there(tmp_path, monkeypatch):
    def fill(figure, path, **options):
        path.write_bytes(b"half")
        raise OSError(ENOSPC, "No space left on device")

    path = tmp_path / "a.png"
    path.write_bytes(b"before")
    monkeypatch.setattr(Figure, "savefig", fill)
    with pytest.raises(FileAccessError, match="No space left"):
        save_picture(new_figure(2.0, PICTURE_WIDTH), path)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]
