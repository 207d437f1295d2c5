"""toml_text: a TOML file drawn from a grammar, with the words of good files of its kind."""

from __future__ import annotations

import json
import random
import tomllib
from collections.abc import Iterator, Mapping

UNITS = ("m", "mm", "deg", "rad", "s", "ms", "Hz", "N", "kg", "g", "N*m", "furlong", "m/s^2", "%")
WORDS = ("", "x", "é", "\u202e", "a.b", "../..", "/dev/null", "nan", "true", "a" * 3000, "\\", "'")
DEEPEST = 4


def toml_text(good: list[bytes], chance: random.Random) -> bytes:
    """A table like one of the good ones, with branches replaced, renamed, moved or left out."""
    trees = [tomllib.loads(text.decode()) for text in good]
    words = Vocabulary(trees)
    tree = _changed(chance.choice(trees), words, chance, 0.04 if chance.random() < 0.7 else 0.3)
    first = "# What is it for?\n" if chance.random() < 0.9 else ""
    return (first + emit(tree)).encode("utf-8", "replace")


class Vocabulary:
    """Keys and values that good files have."""

    def __init__(self, trees: list[dict[str, object]]) -> None:
        pairs = [pair for tree in trees for pair in _pairs(tree)]
        self.keys = sorted({key for key, _ in pairs})
        self.values = [value for _, value in pairs]


def value(words: Vocabulary, chance: random.Random, depth: int = 0) -> object:
    """A value of any kind: of the vocabulary, or of TOML."""
    kinds = [
        lambda: chance.choice(words.values),
        lambda: chance.choice(words.values),
        lambda: chance.randrange(-3, 8),
        lambda: chance.choice((2**63 - 1, -(2**63), 10**9, 0, 1)),
        lambda: chance.uniform(-10.0, 10.0) * 10.0 ** chance.randrange(-12, 12),
        lambda: chance.choice((float("nan"), float("inf"), 1e308, -1e308, 5e-324, -0.0)),
        lambda: chance.random() < 0.5,
        lambda: f"{chance.uniform(-5, 100):.4g} {chance.choice(UNITS)}",
        lambda: chance.choice((*WORDS, *words.keys)),
        lambda: Raw(chance.choice(("1979-05-27", "07:32:00", "1979-05-27T07:32:00Z", "0x10"))),
    ]
    if depth < DEEPEST:
        kinds += [
            lambda: [value(words, chance, depth + 1) for _ in range(chance.choice((0, 1, 3, 6)))],
            lambda: {
                chance.choice(words.keys): value(words, chance, depth + 1)
                for _ in range(chance.randrange(4))
            },
        ]
    return chance.choice(kinds)()


class Raw(str):
    """A value as it stands in the file."""


def emit(tree: Mapping[str, object], before: str = "") -> str:
    """TOML text of a table: plain values, then tables and arrays of tables."""
    lines, tables = [], []
    for key, content in tree.items():
        name = f"{before}{quoted(key)}"
        if isinstance(content, Mapping):
            tables.append(f"[{name}]\n{emit(content, f'{name}.')}")
        elif _is_tables(content):
            tables += [f"[[{name}]]\n{emit(one, f'{name}.')}" for one in content]
        else:
            lines.append(f"{quoted(key)} = {inline(content)}")
    return "\n".join([*lines, *tables]) + "\n"


def inline(content: object) -> str:
    """A value on one line."""
    if isinstance(content, Raw):
        return str(content)
    if isinstance(content, bool):
        return str(content).lower()
    if isinstance(content, str):
        return quoted(content)
    if isinstance(content, list):
        return f"[{', '.join(map(inline, content))}]"
    if isinstance(content, Mapping):
        pairs = (f"{quoted(key)} = {inline(inner)}" for key, inner in content.items())
        return "{" + ", ".join(pairs) + "}"
    return str(content)


def quoted(text: str) -> str:
    return json.dumps(text).replace("\\ud", "\\uE") if text else '""'


def _is_tables(content: object) -> bool:
    return isinstance(content, list) and bool(content) and all(isinstance(c, dict) for c in content)


def _pairs(tree: object) -> Iterator[tuple[str, object]]:
    if isinstance(tree, Mapping):
        for key, content in tree.items():
            yield key, content
            yield from _pairs(content)
    elif isinstance(tree, list):
        for one in tree:
            yield from _pairs(one)


def _changed(tree: object, words: Vocabulary, chance: random.Random, rate: float) -> object:
    if isinstance(tree, Mapping):
        found = {}
        for key, content in tree.items():
            draw = chance.random()
            if draw < 0.25 * rate:
                continue
            name = chance.choice(words.keys) if draw < 0.5 * rate else key
            found[name] = _changed(content, words, chance, rate)
        if chance.random() < rate:
            found[chance.choice(words.keys)] = value(words, chance)
        return found
    if chance.random() < rate:
        return value(words, chance)
    if isinstance(tree, list):
        return [_changed(one, words, chance, rate) for one in tree]
    return tree
