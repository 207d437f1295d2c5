"""whole_file: complete or not at all."""

import pytest

from ves_twin.core.errors import FileAccessError
from ves_twin.core.whole_file import whole_file, write_whole


def test_a_file_that_is_written_replaces_the_old_one(tmp_path):
    write_whole(tmp_path / "a.txt", "one")
    write_whole(tmp_path / "a.txt", "two")
    assert (tmp_path / "a.txt").read_text() == "two"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left on device"), RuntimeError("x"), KeyboardInterrupt()]
)
def test_a_file_that_is_not_finished_leaves_the_old_one_alone(tmp_path, error):
    write_whole(tmp_path / "a.txt", "old")
    expected = FileAccessError if isinstance(error, OSError) else type(error)

    def half() -> None:
        with whole_file(tmp_path / "a.txt") as partial:
            partial.write_text("ha")
            raise error

    with pytest.raises(expected):
        half()
    assert (tmp_path / "a.txt").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_folder_that_takes_no_file_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileAccessError, match=r"cannot write .*a\.txt: Not a directory"):
        write_whole(tmp_path / "file" / "a.txt", "x")
