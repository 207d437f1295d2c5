"""Resources: where models/ and scenarios/ lie, in a checkout and in an installed wheel."""

from __future__ import annotations

from pathlib import Path

from ves_twin.core.errors import FileAccessError, UnknownNameError
from ves_twin.core.missing_file import missing_file


def resource_folder(name: str) -> Path:
    """Folder `models` or `scenarios`: inside the package (wheel) or beside it (checkout).

    Raises:
        FileAccessError: the installation lacks the folder.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / name, package.parent / name):
        if folder.is_dir():
            return folder
    raise FileAccessError(f"the installation lacks its '{name}' folder beside {package}")


def find_resource(kind: str, folder: str, name_or_path: str, suffix: str = ".toml") -> Path:
    """Path of a named resource, or of a file given by its path.

    Args:
        kind: word for messages, for instance "scenario".
        folder: resource folder, for instance "scenarios".
        name_or_path: a bare name such as "position_sine", or a path to a file.
        suffix: file ending of the named resources.

    Raises:
        FileAccessError: a path that does not exist.
        UnknownNameError: a name that does not exist; says the nearest one.
    """
    given = Path(name_or_path)
    if given.suffix or len(given.parts) > 1:
        if _is_file(given):
            return given
        raise missing_file(kind, name_or_path)
    root = resource_folder(folder)
    path = root / f"{name_or_path}{suffix}"
    if _is_file(path):
        return path
    raise UnknownNameError(kind, name_or_path, (p.stem for p in root.glob(f"*{suffix}")))


def beside(naming: Path, name_or_path: str) -> str:
    """What a file names: a file beside it, if there is one of that path, else as it came.

    Args:
        naming: the file that names another one.
        name_or_path: a bare name, which is left as it is, or a path.
    """
    given = Path(name_or_path)
    if not (given.suffix or len(given.parts) > 1) or given.is_absolute():
        return name_or_path
    near = naming.parent / given
    return str(near) if _is_file(near) else name_or_path


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name too long, or with a NUL
        return False
