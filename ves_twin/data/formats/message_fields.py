"""message_fields: the numbers in a decoded message, by paths such as position[0] or pose.x."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

Path = tuple[str | int, ...]
"""Names of fields and places in arrays, from the message inward."""

MOST = 64
"""Longest array whose elements become columns; longer ones are pictures and clouds."""

LATEST = 2**63
"""Largest count of a stamp: 64 bits."""

STAMPS = ({"sec", "nanosec"}, {"secs", "nsecs"}, {"sec", "nsec"}, {"seconds", "nanos"})
"""Fields of a time: seconds and nanoseconds."""


def number_paths(message: Any, before: Path = ()) -> Iterator[Path]:
    """Paths to every number and every time of a message; texts are passed over."""
    for key, value in fields_of(message):
        path = (*before, key)
        if isinstance(value, bool | int | float) or _stamp(value) is not None:
            yield path
        elif not isinstance(value, str | bytes | bytearray) and not _is_long(value):
            yield from number_paths(value, path)


def long_arrays(message: Any, before: Path = ()) -> Iterator[Path]:
    """Paths to arrays that are too long to be channels."""
    for key, value in fields_of(message):
        path = (*before, key)
        if _is_long(value):
            yield path
        elif not isinstance(value, str | bytes | bytearray | bool | int | float):
            yield from long_arrays(value, path)


def element_names(message: Any) -> tuple[str, ...]:
    """What a message calls the elements of its arrays, as joint states do; () if it does not."""
    names: Any = next((value for key, value in fields_of(message) if key == "name"), ())
    if not _is_array(names) or not all(isinstance(one, str) for one in names):
        return ()
    return tuple(names) if len(set(names)) == len(names) <= MOST else ()


def all_elements(messages: Sequence[Any]) -> tuple[tuple[str, ...], frozenset[str]]:
    """Names of elements of some messages, in the order in which they come, and their arrays.

    Arrays that are as long as the names wherever they hold anything.
    """
    names: dict[str, None] = {}
    named: dict[str, bool] = {}
    for message in messages:
        own = element_names(message)
        names |= dict.fromkeys(own)
        for key, value in fields_of(message) if own else ():
            if key != "name" and _is_array(value) and len(value):
                named[str(key)] = named.get(str(key), True) and len(value) == len(own)
    return tuple(names), frozenset(key for key, fits in named.items() if fits)


def path_name(path: Path) -> str:
    """A path as text."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return text.removeprefix(".")


def number_at(message: Any, path: Path, origin: int) -> float:
    """The number at a path, a time as seconds since `origin` [ns]; NaN where there is none."""
    value = message
    for part in path:
        try:
            if isinstance(part, int) or isinstance(value, Mapping):
                value = value[part]
            else:
                value = getattr(value, part)
        except (AttributeError, IndexError, KeyError, TypeError):
            return float("nan")
    nanoseconds = _stamp(value)
    if nanoseconds is not None:
        return (nanoseconds - origin) * 1e-9
    try:
        return float(value) if isinstance(value, bool | int | float) else float("nan")
    except OverflowError:  # an integer beyond doubles
        return float("nan")


def fields_of(message: Any) -> Iterator[tuple[str | int, Any]]:
    """Fields of a message or elements of an array, whatever decoded it."""
    if isinstance(message, Mapping):
        yield from ((str(key), value) for key, value in message.items())
    elif hasattr(message, "DESCRIPTOR"):
        yield from ((f.name, getattr(message, f.name)) for f in message.DESCRIPTOR.fields)
    elif hasattr(message, "__slots__") or hasattr(message, "__dict__"):
        names = getattr(message, "__slots__", None) or vars(message)
        yield from ((name, getattr(message, name)) for name in names if hasattr(message, name))
    elif hasattr(message, "__len__") and hasattr(message, "__getitem__"):
        yield from enumerate(message)


def _is_array(value: Any) -> bool:
    plain = isinstance(value, str | Mapping) or hasattr(value, "DESCRIPTOR")
    return hasattr(value, "__len__") and hasattr(value, "__getitem__") and not plain


def _is_long(value: Any) -> bool:
    return _is_array(value) and len(value) > MOST


def _stamp(value: Any) -> int | None:
    """Nanoseconds, if a value is a time."""
    if isinstance(value, str | bytes | bool | int | float) or _is_array(value):
        return None
    parts = dict(fields_of(value))
    if set(parts) not in STAMPS:
        return None
    nanoseconds, seconds = (parts[name] for name in sorted(parts, key=str))
    whole = isinstance(seconds, int) and isinstance(nanoseconds, int)
    if not whole or abs(seconds) > LATEST or abs(nanoseconds) > LATEST:
        return None
    return int(seconds * 10**9 + nanoseconds)
