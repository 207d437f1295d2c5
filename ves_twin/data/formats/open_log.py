"""open_log: a lab file by its content, not by its name; what must not be read is refused."""

from __future__ import annotations

import zipfile
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME
from ves_twin.data.formats.array_log import ArrayLog
from ves_twin.data.formats.columnar_log import ArrowLog, ParquetLog
from ves_twin.data.formats.csv_log import CsvLog
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.log import Log
from ves_twin.data.formats.mat_log import mat_73, mat_log
from ves_twin.data.formats.npz_log import PICKLE, npz_log

HDF5 = b"\x89HDF\r\n\x1a\n"
READABLE = "CSV, Parquet, Arrow, MAT v5, npz or MCAP"

REFUSED = {
    b"#ROSBAG": ("a ROS 1 bag", "MCAP; `mcap convert FILE.bag FILE.mcap`"),
    b"SQLite format 3": ("a ROS 2 bag in SQLite", "MCAP; `ros2 bag convert` with storage mcap"),
    b"RRF": ("a rerun file", "the recording.parquet beside it"),
    b"TDSm": ("a TDMS file", "CSV; export it in the program that wrote it"),
}
"""First bytes -> what it is and what to bring instead."""


def open_log(path: str | Path, limits: Limits | None = None) -> Log:
    """Open a lab file, or the recording in the folder of a run.

    Args:
        path: of the file or the folder.
        limits: what it may unfold to; the usual ones if left out.

    Raises:
        FileAccessError: missing or unreadable.
        InvalidInputError: empty, of a kind that is not read, or one that could run code.
    """
    file = Path(path)
    if file.is_dir():
        found = [file / n for n in (STREAM_NAME, FILE_NAME) if (file / n).is_file()]
        if not found:
            raise FileAccessError(f"folder {file} holds no recording; name a file in it")
        file = found[0]
    try:
        with file.open("rb") as stream:
            head = stream.read(640)
    except OSError as error:
        raise FileAccessError(f"lab file '{file}': {error.strerror}") from None
    if not head:
        raise InvalidInputError(file.name, "0 bytes", READABLE)
    for magic, (came, wanted) in REFUSED.items():
        if head.startswith(magic):
            raise InvalidInputError(file.name, came, wanted)
    if _is_pickle(file, head):
        raise InvalidInputError(file.name, PICKLE, READABLE)
    return _opened(file, head, limits)


def _opened(file: Path, head: bytes, limits: Limits | None) -> Log:
    if head.startswith(b"\x89MCAP"):
        from ves_twin.data.formats.mcap_log import McapLog  # its packages are an extra

        return McapLog(file, limits)
    if head.startswith(HDF5) or head[512:520] == HDF5:
        if head.startswith(b"MATLAB") or file.suffix == ".mat":
            raise mat_73(file)
        raise InvalidInputError(file.name, "an HDF5 file", READABLE)
    if head.startswith(b"PAR1"):
        return ParquetLog(file, limits)
    if head.startswith((b"ARROW1", b"\xff\xff\xff\xff")):
        return ArrowLog(file, limits)
    if head.startswith(b"MATLAB 5") or file.suffix == ".mat":
        return mat_log(file, limits)
    if head.startswith(b"\x93NUMPY") or head.startswith(b"PK\x03\x04"):
        return _archive(file, head, limits)
    return CsvLog(file, limits)


def _archive(file: Path, head: bytes, limits: Limits | None) -> ArrayLog:
    if head.startswith(b"PK"):
        try:
            names = zipfile.ZipFile(file).namelist()
        except Exception:  # zipfile raises several kinds
            raise InvalidInputError(file.name, "a damaged archive", READABLE) from None
        if any(name.startswith("xl/") for name in names):
            raise InvalidInputError(file.name, "an Excel sheet", "CSV; save the sheet as such")
        if not any(name.endswith(".npy") for name in names):
            raise InvalidInputError(file.name, "an archive without arrays", READABLE)
    return npz_log(file, limits)


def _is_pickle(file: Path, head: bytes) -> bool:
    """By its first bytes (protocol 2 on) or by its name."""
    named = file.suffix in {".pkl", ".pickle", ".joblib"}
    return named or (head[0] == 0x80 and head[1:2] in (b"\x02", b"\x03", b"\x04", b"\x05"))
