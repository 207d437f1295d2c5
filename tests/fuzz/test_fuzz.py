"""Harmed files: each is read, or refused in one clear line; nothing runs, hangs or blows up.

1000 mutations in `make test`, 10000 in `make nightly` and `make fuzz` (`--mutations N`). A failure names the seed and
keeps the file.
"""

from __future__ import annotations

import random
import resource
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from mutate import mutate_bytes, mutate_text
from targets import TARGETS, Target

from ves_twin.core.errors import VesTwinError

ROOM = 3 * 2**30
"""Memory that reading harmed files may take on top of what the process has [bytes]."""

RUNS_PER_MUTATION = 0.05
"""Share of the mutations that are also run where they can be read: a run takes 0.1 s."""

LONGEST = 1500
"""Characters of the longest message that still counts as a line; an echoed value is cut."""


@pytest.fixture(autouse=True)
def _bounded_memory() -> Iterator[None]:
    """A blow-up becomes a MemoryError, which no reader may raise."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm", encoding="ascii") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + ROOM, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS, ids=[target.name for target in TARGETS])
def test_a_harmed_file_is_read_or_refused_in_one_line(
    target: Target, request, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    mutations = round(target.share * request.config.getoption("--mutations"))
    good, chance = target.good(), random.Random(target.name)
    runs = round(mutations * RUNS_PER_MUTATION) if target.run else 0
    read = 0
    path = tmp_path / target.name
    for k in range(mutations):
        seed = f"{target.name} {k}"
        content = good[k % len(good)]
        harmed = (
            mutate_text(content.decode(), seed, chance.choice((1, 1, 1, 2, 5)))
            if target.text
            else mutate_bytes(content, seed)
        )
        path.write_bytes(harmed)
        if _stands(target.read, path, seed):
            read += 1
            if runs and target.run is not None:
                runs -= 1
                _stands(target.run, path, f"run of {seed}")
    assert read < mutations  # a fuzz that harms nothing tests nothing
    assert {p.name.split("-sweep")[0] for p in tmp_path.iterdir()} == {target.name}


def test_a_good_file_of_each_kind_is_read(tmp_path):
    for target in TARGETS:
        if target.name == "learned.parquet":
            continue  # what is harmed is a recording, which is not one
        for number, content in enumerate(target.good()):
            path = tmp_path / f"{number}-{target.name}"
            path.write_bytes(content)
            target.read(path)


def _stands(use, path: Path, seed: str) -> bool:
    """Whether a file could be used; a refusal is one clear line, anything else a failure."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # overflow of absurd numbers
            warnings.simplefilter("ignore", UserWarning)  # the engine's, of an absurd rig
            use(path)
    except VesTwinError as error:
        text = str(error)
        assert text, seed
        assert "\n" not in text, f"{seed}: {text[:300]!r}"
        assert len(text) < LONGEST, f"{seed}: {len(text)} characters: {text[:300]}"
        return False
    except BaseException as error:
        kept = Path(tempfile.gettempdir()) / f"fuzz-{seed.replace(' ', '-')}"
        kept.write_bytes(path.read_bytes())
        said = f"{type(error).__name__}: {str(error)[:200]}"
        raise AssertionError(f"{seed}: {said}; kept in {kept}") from error
    return True
