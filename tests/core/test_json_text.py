"""What a command prints as JSON is JSON."""

import json
from math import inf, nan

import pytest

from ves_twin.core.json_text import json_text


def refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is not JSON")


def test_numbers_that_are_not_finite_become_null_at_any_depth():
    content = {"growth": inf, "points": [{"limit": (-inf, nan, 1.5)}], "name": "nan"}
    read = json.loads(json_text(content), parse_constant=refuse)
    assert read == {"growth": None, "points": [{"limit": [None, None, 1.5]}], "name": "nan"}


def test_finite_content_is_written_as_json_writes_it():
    content = {"a": [1, 2.5, True, None], "b": {"c": "text"}}
    assert json_text(content) == json.dumps(content, indent=2)
    assert json_text(content, indent=None) == json.dumps(content)


def test_what_is_no_plain_value_is_refused():
    with pytest.raises(TypeError):
        json_text({"a": object()})
