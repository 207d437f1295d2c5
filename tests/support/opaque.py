"""opaque_mat: a MAT file with an object that only MATLAB can open."""

import struct
from pathlib import Path

import numpy as np


def opaque_mat(path: Path, name: str, kind: str) -> None:
    """A MAT file with numbers `t` and one object that only MATLAB can open (MCOS, class 17)."""

    def element(number: int, data: bytes) -> bytes:
        return struct.pack("<II", number, len(data)) + data + b"\0" * (-len(data) % 8)

    def text(word: str) -> bytes:
        return element(1, word.encode())

    def matrix(flags: int, body: bytes) -> bytes:
        return element(14, element(6, struct.pack("<II", flags, 0)) + body)

    numbers = np.arange(8.0)
    plain = element(5, struct.pack("<ii", 8, 1)) + text("t") + element(9, numbers.tobytes())
    inner = element(5, struct.pack("<ii", 1, 1)) + text("") + element(9, struct.pack("<d", 1.0))
    body = text(name) + text("MCOS") + text(kind) + matrix(6, inner)
    head = b"MATLAB 5.0 MAT-file".ljust(116) + b"\0" * 8 + struct.pack("<H", 0x0100) + b"IM"
    path.write_bytes(head + matrix(6, plain) + matrix(17, body))
