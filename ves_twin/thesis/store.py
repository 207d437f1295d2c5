"""Store: evaluations kept on disk, valid only for the same plant, code and data."""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from ves_twin.core.cache_folder import cache_folder
from ves_twin.core.errors import FileAccessError
from ves_twin.core.resources import resource_folder
from ves_twin.core.whole_file import write_whole
from ves_twin.simulator.simulate import versions
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Evaluation


@dataclass(frozen=True)
class Store:
    """A folder of evaluations; what is damaged or unwritable is computed again."""

    folder: Path

    @staticmethod
    def of_user() -> Store:
        """The user's cache folder of the present code and data."""
        return Store(cache_folder(f"thesis-{code_hash()}"))

    def get(self, context: Context, claim: str) -> Evaluation | None:
        """What was kept for a claim in a context, if anything."""
        try:
            content = json.loads(self._path(context, claim).read_text(encoding="utf-8"))
            return Evaluation(
                values=tuple(map(float, content["values"])),
                holds=content["holds"],
                note=str(content["note"]),
                runs=tuple(map(str, content["runs"])),
            )
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def put(self, context: Context, claim: str, found: Evaluation) -> None:
        """Keep an evaluation; a folder that cannot be written is passed over."""
        path = self._path(context, claim)
        with suppress(OSError, FileAccessError):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, json.dumps(asdict(found)))

    def _path(self, context: Context, claim: str) -> Path:
        world = f"{context.plant.hash} {context.plant_name} {context.models} {context.quick}"
        return self.folder / hashlib.sha256(world.encode()).hexdigest()[:16] / f"{claim}.json"


@lru_cache(maxsize=1)
def code_hash() -> str:
    """Hash over the package's sources, its models and scenarios, and the libraries' versions."""
    digest = hashlib.sha256(json.dumps(versions(), sort_keys=True).encode())
    package = Path(__file__).resolve().parent.parent
    roots = ((package, "*.py"), *((resource_folder(n), "*") for n in ("models", "scenarios")))
    for root, pattern in roots:
        for path in sorted(p for p in root.rglob(pattern) if p.is_file()):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
