"""load_description: a machine's TOML file, with what it says over another one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.refusal import refusal
from ves_twin.core.resources import find_resource, resource_folder
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.machines.mjcf.rig.description import KIND, SCHEMA, RigDescription


def is_rig(name_or_path: str) -> bool:
    """Whether a --plant option means an MJCF machine rather than a plant of VES II."""
    path = Path(name_or_path)
    if not path.suffix and len(path.parts) == 1:
        return name_or_path in shipped_rigs()
    return path.is_file() and read_toml("plant", path)[0].get("kind") == KIND


def shipped_rigs() -> list[str]:
    """Names of the rigs that come with the twin."""
    return sorted(p.name for p in _machines().iterdir() if _shipped(p.name).is_file())


def load_description(name_or_path: str) -> tuple[RigDescription, Path]:
    """The description of a rig, and the folder that its model is found from.

    A file with `base` adds to another one: its tables `parameters`, `present` and `laws` are put
    on top; a law in place of one with the same place and variables.

    Raises:
        FileAccessError: missing file.
        UnknownNameError: unknown name or key; says the nearest one.
        InvalidInputError: wrong type or unit; says the key.
        VersionError: another schema.
    """
    shipped = name_or_path in shipped_rigs()
    path = _shipped(name_or_path) if shipped else find_resource("rig", "models", name_or_path)
    content, folder = _content(path, 0)
    try:
        return RigDescription.model_validate(content), folder
    except ValidationError as error:
        raise refusal(error, path.name, RigDescription) from None


def _machines() -> Path:
    return resource_folder("models") / "machines"


def _shipped(name: str) -> Path:
    return _machines() / name / f"{name}.toml"


def _content(path: Path, depth: int) -> tuple[dict[str, Any], Path]:
    content, _ = read_toml("rig", path)
    check_schema(content, path, SCHEMA)
    if content.pop("kind", None) != KIND:
        raise InvalidInputError(f"{path}: kind", None, f'"{KIND}"')
    content.pop("schema")
    base = content.pop("base", None)
    if base is None:
        return content, path.parent
    if depth > 3 or not isinstance(base, str):
        raise InvalidInputError(f"{path}: base", base, "the file of a rig, four deep at most")
    below = _shipped(base) if base in shipped_rigs() else path.parent / base
    under, folder = _content(below, depth + 1)
    return _over(under, content), folder


def _over(under: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """The base with what is put on top of it."""
    added = ("parameters", "present", "laws")
    merged = {**under, **{k: v for k, v in top.items() if k not in added}}
    new = list(top.get("parameters", []))
    places = {_place(s) for s in new}
    merged["parameters"] = [s for s in under.get("parameters", []) if _place(s) not in places] + new
    present = {kind: dict(targets) for kind, targets in under.get("present", {}).items()}
    for kind, targets in top.get("present", {}).items():
        present.setdefault(kind, {}).update(targets)
    merged["present"] = present
    laws = {(law.get("place"), str(law.get("of"))): law for law in under.get("laws", [])}
    laws |= {(law.get("place"), str(law.get("of"))): law for law in top.get("laws", [])}
    merged["laws"] = list(laws.values())
    return merged


def _place(setting: dict[str, Any]) -> tuple[object, ...]:
    return tuple(setting.get(key) for key in ("body", "joint", "actuator", "tendon", "attribute"))
