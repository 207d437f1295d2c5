"""pinned_recipe: a suite that was begun is made to its end by the recipe that it was begun with."""

from __future__ import annotations

import json
import secrets
from dataclasses import asdict, replace
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.whole_file import whole_file
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.seal import seal, unseal

FILE = "recipe.sealed"


def pinned_recipe(recipe: Recipe, folder: Path, key: str) -> Recipe:
    """The recipe with its seed, sealed into the folder; of a suite that was begun, its own.

    Args:
        recipe: what is asked for; without a seed any is meant.
        folder: of the suite.
        key: of its seal.

    Raises:
        InvalidInputError: the folder was begun with another recipe, or holds cases without one.
        FileAccessError: not writable.
    """
    path = folder / FILE
    if not path.is_file():
        if any(folder.glob("case-*")):
            raise InvalidInputError(str(folder), "cases without their recipe", "an empty folder")
        seed = secrets.randbelow(2**31) if recipe.seed is None else recipe.seed
        recipe = replace(recipe, seed=seed)
        with whole_file(path) as partial:
            partial.write_bytes(seal(json.dumps(asdict(recipe)), key))
        return recipe
    try:
        begun = json.loads(unseal(path.read_bytes(), key, str(path)))
        begun.setdefault("machine", begun.get("bench"))
        begun.setdefault("model_error", 0.0)
    except OSError as error:
        raise FileAccessError(f"cannot read {path}: {error.strerror}") from None
    asked = asdict(recipe) | ({"seed": begun["seed"]} if recipe.seed is None else {})
    for recipes in (asked, begun):  # a sort that came later is not asked for by an earlier one
        recipes["counts"] = {sort: count for sort, count in recipes["counts"].items() if count}
    other = [name for name in asked if asked[name] != begun[name]]
    if other:
        what = f"{folder}: {', '.join(other)}"
        raise InvalidInputError(
            what, "not what the suite was begun with", "the same, or an empty folder"
        )
    return replace(recipe, seed=begun["seed"])
