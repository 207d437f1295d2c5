"""A path that is not there is answered with the nearest name of its folder."""

from ves_twin.core.missing_file import missing_file


def test_a_misspelt_name_gets_the_nearest_file_of_its_folder(tmp_path):
    (tmp_path / "held.csv").touch()
    (tmp_path / "other.toml").touch()
    told = str(missing_file("recording", tmp_path / "hedl.csv"))
    assert told.startswith(f"recording file '{tmp_path / 'hedl.csv'}' does not exist")
    assert told.endswith(f"did you mean '{tmp_path / 'held.csv'}'?")


def test_a_name_that_resembles_none_gets_no_hint(tmp_path):
    (tmp_path / "held.csv").touch()
    told = str(missing_file("", tmp_path / "plan.toml"))
    assert told == f"file '{tmp_path / 'plan.toml'}' does not exist"


def test_a_folder_that_is_missing_as_well_is_named(tmp_path):
    told = str(missing_file("recording", tmp_path / "runs" / "held.csv", " here"))
    assert told.endswith(f"does not exist here; nor does its folder '{tmp_path / 'runs'}'")
