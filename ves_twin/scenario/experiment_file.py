"""ExperimentFile: what an experiment file says of recordings, and of single ones among them."""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from pydantic import Field, ValidationError

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.refusal import refusal
from ves_twin.core.toml_file import read_toml
from ves_twin.scenario.fields import Part

BY_NUMBERS = ("declared", "auto")
"""What `noise` says where no recording tells it."""


class ExperimentFile(Part, ABC):
    """What is said of all recordings; `recordings` holds what single ones have of their own."""

    parameters: Mapping[str, Any] = Field(default_factory=dict)
    noise: str = "declared"
    recordings: Mapping[str, Part] = Field(default_factory=dict)

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """An experiment from a TOML file.

        Raises:
            FileAccessError: missing or unreadable file.
            UnknownNameError: unknown key or signal; says the nearest one.
            InvalidInputError: wrong type, unit or range; says the key.
        """
        content, _ = read_toml("experiment", Path(path))
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            raise refusal(error, Path(path).name, cls) from None

    def of(self, name: str) -> Self:
        """The experiment of one recording, by its name with or without its ending."""
        own = self.recordings.get(name) or self.recordings.get(Path(name).stem)
        if own is None:
            return self
        said = {k: v for k in type(own).model_fields if (v := getattr(own, k)) is not None}
        said["parameters"] = {**self.parameters, **said["parameters"]}
        return self.model_copy(update=said)

    def check_names(self, names: Sequence[str]) -> None:
        """Raise UnknownNameError if it speaks of a recording that is not there."""
        known = {*names, *(Path(name).stem for name in names)}
        for name in self.recordings:
            if name not in known:
                raise UnknownNameError("recording in the experiment", name, known)

    def noise_source(self, names: Sequence[str]) -> str:
        """The recording that tells the noise of all of these; empty where none does.

        Raises:
            UnknownNameError: it speaks of a recording that is not there.
            InvalidInputError: two recordings of one name, or of noise sources that differ.
        """
        self.check_names(names)
        if len(set(names)) < len(names):
            raise InvalidInputError("recordings", "two of one name", "names that tell them apart")
        sources = {self.of(name).noise for name in names}
        files = {"" if source in BY_NUMBERS else source for source in sources}
        if len(files) > 1:
            raise InvalidInputError("noise", sorted(sources), "one noise source in all recordings")
        return files.pop() if files else ""
