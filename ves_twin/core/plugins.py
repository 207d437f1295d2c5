"""Registry: built-in implementations by name, and those that installed packages add."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from typing import TypeVar

from ves_twin.core.errors import PluginError, UnknownNameError, one_line

Kind = TypeVar("Kind")


class Registry(Mapping[str, Kind]):
    """Names to implementations: a literal table, and the entry points of one group.

    A package adds a name by an entry point of the group; its module is imported when the name is
    asked for, not before. A name that two sides claim is refused, never settled by order.

    Args:
        group: entry point group, for instance "ves_twin.controllers".
        built_in: what comes with the twin.
        problem: says in some words what is wrong with a loaded object, or None.
        also: an earlier group whose entry points are read as well.
        renamed: earlier names of built-in implementations -> today's; understood, never listed.
    """

    def __init__(
        self,
        group: str,
        built_in: Mapping[str, Kind],
        problem: Callable[[object], str | None],
        also: str = "",
        renamed: Mapping[str, str] | None = None,
    ) -> None:
        self.group = group
        self._built_in = dict(built_in)
        self._problem = problem
        self._groups = (group, also) if also else (group,)
        self._renamed = dict(renamed or {})

    def __getitem__(self, name: str) -> Kind:
        """The implementation of a name.

        Raises:
            UnknownNameError: no such name; says the nearest one.
            PluginError: two packages claim the name, or the package's one cannot be loaded.
        """
        name, points = self._renamed.get(name, name), self._points()
        self._check_claims(name, points)
        if name in self._built_in:
            return self._built_in[name]
        if name not in points:
            raise UnknownNameError(f"name in {self.group}", name, self)
        return self._load(points[name][0])

    def __contains__(self, name: object) -> bool:
        return name in self._built_in or name in self._renamed or name in self._points()

    def __iter__(self) -> Iterator[str]:
        return iter([*self._built_in, *(n for n in self._points() if n not in self._built_in)])

    def __len__(self) -> int:
        return len(list(iter(self)))

    @property
    def built_in(self) -> tuple[str, ...]:
        """Names that come with the twin."""
        return tuple(self._built_in)

    def plugins(self) -> dict[str, str]:
        """Names that installed packages add -> where each comes from; nothing is imported."""
        return {
            name: ", ".join(map(_origin, points)) for name, points in sorted(self._points().items())
        }

    def _points(self) -> dict[str, list[EntryPoint]]:
        found: dict[str, list[EntryPoint]] = {}
        for group in self._groups:
            for point in _installed(group, tuple(sys.path)):
                found.setdefault(point.name, []).append(point)
        return found

    def _check_claims(self, name: str, points: Mapping[str, list[EntryPoint]]) -> None:
        claims = [_origin(point) for point in points.get(name, [])]
        if name in self._built_in:
            claims.insert(0, "ves_twin itself")
        if len(claims) > 1:
            raise PluginError(f"{self.group}: '{name}' is claimed by {' and by '.join(claims)}")

    def _load(self, point: EntryPoint) -> Kind:
        try:
            loaded = point.load()
        except Exception as error:
            raise PluginError(
                f"{self.group}: '{point.name}' of {_origin(point)} cannot be loaded:"
                f" {type(error).__name__}: {one_line(error)}"
            ) from error
        wrong = self._problem(loaded)
        if wrong is not None:
            raise PluginError(f"{self.group}: '{point.name}' of {_origin(point)} {wrong}")
        return loaded  # type: ignore[no-any-return]


@lru_cache(maxsize=64)
def _installed(group: str, path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """Entry points of a group along an import path; looked up once, since that takes 18 ms."""
    return tuple(entry_points(group=group))


def lacks(base: type) -> Callable[[object], str | None]:
    """A check for `Registry`: the object is a concrete class below `base`."""

    def problem(loaded: object) -> str | None:
        if not isinstance(loaded, type) or not issubclass(loaded, base):
            return f"is not a class derived from {base.__name__}"
        missing = sorted(getattr(loaded, "__abstractmethods__", ()))
        return f"lacks {', '.join(missing)}" if missing else None

    return problem


def _origin(point: EntryPoint) -> str:
    package = f"{point.dist.name} {point.dist.version}" if point.dist else "an unnamed package"
    return f"{package} ({point.value})"
