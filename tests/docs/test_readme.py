"""README: short, every command understood, every link there."""

import re
from pathlib import Path

import pytest

from ves_twin.cli.main import COMMANDS, build_parser

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
TYPED = re.findall(r"(?:^    |`)(ves-twin [a-z](?:[^`\n\\]|\\\n)*)", TEXT, flags=re.MULTILINE)


def test_it_is_short_and_has_few_links():
    assert len(TEXT.splitlines()) <= 120
    assert len(re.findall(r"(?<!!)\[[^\]]*\]\([^)]*\)", TEXT)) <= 8


def test_every_link_leads_somewhere():
    for target in re.findall(r"\]\(([^)#]*)\)", TEXT):
        assert (ROOT / target).is_file(), target


@pytest.mark.parametrize("line", TYPED)
def test_every_command_is_understood(line):
    words = line.replace("\\\n", " ").split("#")[0].split()
    assert build_parser().parse_args(words[1:]).command == words[1]


def test_the_table_has_every_command():
    rows = re.findall(r"^\| `([a-z]+)` \|", TEXT, flags=re.MULTILINE)
    assert sorted(rows) == sorted(COMMANDS)
