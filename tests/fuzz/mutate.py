"""mutate_text and mutate_bytes: one small harm to a file, the same for the same seed."""

from __future__ import annotations

import random
import re

NASTY = (
    "nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "-1", "0", "-0.0", "1e400", str(10**40),
    "true", "[]", "{}", '""', '"x"', '"5 kg"', '"1e9 m"', '"-3 deg"', "1979-05-27", "[[1, 2], [3]]",
    "[nan, 1, 2, 3, 4, 5]", '["a", 1, 2]', '"../../../../etc/passwd"', '"\\u0000"', '"ves2"',
    "[" * 3000 + "]" * 3000, '"' + "y" * 20000 + '"', "{ a = { b = { c = 1 } } }",
    '"__import__(\'os\').system(\'touch PWNED\')"', "[0, 0, 0, 0, 0, 0]", "9223372036854775808",
)  # fmt: skip
"""Values that are wrong nearly anywhere, and some that are right somewhere."""

_NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
_SEPARATOR = re.compile(r"[=,\[\]\"\n.#]")


def mutate_text(text: str, seed: str, harms: int = 1) -> bytes:
    """A text file with some small harms: values, keys, lines, letters, bytes."""
    chance = random.Random(seed)
    for _ in range(harms):
        text = chance.choice(_TEXT_HARMS)(text, chance)
    content = text.encode("utf-8", errors="surrogatepass")
    return mutate_bytes(content, seed) if chance.random() < 0.1 else content


def mutate_bytes(content: bytes, seed: str) -> bytes:
    """A binary file with flipped, lost, doubled or swapped bytes."""
    chance = random.Random(seed)
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 3, 30))):
        if not data:
            break
        at = chance.randrange(len(data))
        size = chance.choice((1, 4, 64, 4096))
        harm = chance.randrange(5)
        if harm == 0:
            data[at] ^= 1 << chance.randrange(8)
        elif harm == 1:
            del data[at : at + size]
        elif harm == 2:
            data[at:at] = data[at : at + size]
        elif harm == 3:
            data[at : at + size] = chance.randbytes(min(size, len(data) - at))
        elif chance.random() < 0.3:
            del data[at:]
    return bytes(data)


def _value(text: str, chance: random.Random) -> str:
    lines = text.split("\n")
    given = [i for i, line in enumerate(lines) if "=" in line and not line.startswith("#")]
    if given:
        at = chance.choice(given)
        lines[at] = f"{lines[at].split('=')[0]}= {chance.choice(NASTY)}"
    return "\n".join(lines)


def _number(text: str, chance: random.Random) -> str:
    found = list(_NUMBER.finditer(text))
    if not found:
        return text
    hit = chance.choice(found)
    value = chance.choice((*NASTY[:12], f"{hit[0]}{chance.randrange(10)}", f"-{hit[0]}"))
    return text[: hit.start()] + value + text[hit.end() :]


def _key(text: str, chance: random.Random) -> str:
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    where = chance.randrange(len(lines[at]) + 1)
    lines[at] = lines[at][:where] + chance.choice(("x", "", ".", " ", "_")) + lines[at][where + 1 :]
    return "\n".join(lines)


def _lines(text: str, chance: random.Random) -> str:
    lines = text.split("\n")
    one, two = chance.randrange(len(lines)), chance.randrange(len(lines))
    harm = chance.randrange(3)
    if harm == 0:
        del lines[one]
    elif harm == 1:
        lines.insert(two, lines[one])
    else:
        lines[one], lines[two] = lines[two], lines[one]
    return "\n".join(lines)


def _letter(text: str, chance: random.Random) -> str:
    found = list(_SEPARATOR.finditer(text))
    if not found:
        return text
    at = chance.choice(found).start()
    return (
        text[:at]
        + chance.choice(("", "=", "[", "]]", '"', "\x00", "\ufeff", "é", "\n"))
        + text[at + 1 :]
    )


def _cut(text: str, chance: random.Random) -> str:
    return text[: chance.randrange(len(text) + 1)]


_TEXT_HARMS = (_value, _value, _value, _number, _number, _key, _lines, _letter, _cut)
