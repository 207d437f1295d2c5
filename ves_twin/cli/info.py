"""info: versions, models, controllers; with --plant what differs from the nominal rig."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.json_text import json_text
from ves_twin.core.units import unit_tail

if TYPE_CHECKING:
    from ves_twin.effects.effect import Effect

SUMMARY = "versions, models and controllers; with --plant what differs from nominal"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("--plant", metavar="FILE", help="a machine: a name or a TOML file")
    parser.add_argument(
        "--mjcf", metavar="OUT", help="with --plant: write it as MJCF, and say what MJCF lacks"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Print what is installed and known."""
    if arguments.mjcf and not arguments.plant:
        raise InvalidInputError("--mjcf", "no --plant", "--plant NAME or FILE beside it")
    content = general_content() if not arguments.plant else _told(arguments.plant, arguments.mjcf)
    if arguments.json:
        print(json_text(content))
        return 0
    for title, entries in content.items():
        print(f"{title}:" if not isinstance(entries, str) else f"{title}: {entries}")
        if isinstance(entries, dict):
            if not entries:
                print("  none")
            width = max(map(len, entries), default=0)
            for name, value in entries.items():
                print(f"  {name:<{width}}  {value if isinstance(value, str) else _words(value)}")
        elif isinstance(entries, list):
            print(f"  {', '.join(map(str, entries))}" if entries else "  none")
    return 0


def general_content() -> dict[str, object]:
    """Versions, plants, emulated systems, controllers, plugins, scenarios, signals."""
    from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
    from ves_twin.core.compiled import compiled_folder
    from ves_twin.core.resources import resource_folder
    from ves_twin.core.signals import SIGNALS
    from ves_twin.effects.registry import EFFECTS
    from ves_twin.envs import ENVIRONMENTS
    from ves_twin.envs.baselines import BASELINES
    from ves_twin.machines.load import shipped_machines
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.load import scenario_questions
    from ves_twin.simulator.simulate import versions

    models = resource_folder("models")
    return {
        "versions": versions(),
        "plants": {p.stem: Plant.load(p.stem).hash for p in sorted(models.glob("*.toml"))},
        "emulated systems": [p.stem for p in sorted((models / "emulated").glob("*.toml"))],
        "effects": {kind: _places(EFFECTS[kind]) for kind in EFFECTS.built_in},
        "platform controllers": list(PLATFORM_CONTROLLERS),
        "gravity compensations": list(GRAVITY_COMPENSATIONS),
        "plugins": {
            f"{registry.group}: {name}": origin
            for registry in (PLATFORM_CONTROLLERS, GRAVITY_COMPENSATIONS, EFFECTS)
            for name, origin in registry.plugins().items()
        },
        "scenarios": list(scenario_questions()),
        "environments": list(ENVIRONMENTS),
        "rigs of two files": shipped_machines(),
        "sets of rigs": [p.stem for p in sorted((models / "rig_sets").glob("*.toml"))],
        "baseline policies": list(BASELINES),
        "signals": {
            s.name: f"{s.width} {', '.join(dict.fromkeys(s.units))}; {s.role.value}; {s.meaning}"
            for s in SIGNALS.values()
        },
        "compiled code": str(compiled_folder()),
    }


def _places(effect: type[Effect]) -> str:
    """Sizes with units and targets: on VES II, then on other machines."""
    found = []
    for row in effect.rows:
        on = row.targets if len(row.targets) < 4 else (row.targets[0], "...")
        sizes = [f"{m.name} [{m.unit}]" for m in effect.magnitudes_of(row.targets[0])]
        found.append(f"{', '.join(sizes)}, on {' '.join(on)}")
    if effect.anywhere:
        found.append(f"{', '.join(s.name for s in effect.sizes)}, on any {effect.anywhere.element}")
    return "; ".join(found)


def _told(name: str, out: str | None) -> dict[str, object]:
    """One machine; written as MJCF what the file has of its changes, and what it has not."""
    from pathlib import Path

    from ves_twin.machines.machine import Machine

    machine = Machine.load(name)
    content = dict(machine.account())
    if out is None:
        return content
    inputs = {Path(one).resolve() for one in (name, str(content.get("model", name)))}
    if Path(out).resolve() in inputs or Path(out).suffix == ".toml":
        raise InvalidInputError("--mjcf", out, "another file than those of the machine, OUT.xml")
    export = machine.mjcf(Path(out).parent)
    export.save(Path(out))
    return {
        **content,
        "MJCF": out,
        "changes that the MJCF has": list(export.carried),
        "changes that it cannot carry": list(export.lost),
        **({"look": export.note} if export.note else {}),
        "what no MJCF carries": {str(n): what for n, what in enumerate(export.never, 1)},
    }


def _words(difference: dict[str, object]) -> str:
    """Nominal and present value; of a list that changes in part only those entries, from 1."""
    before, now, tail = (
        difference["nominal"],
        difference["here"],
        unit_tail(str(difference["unit"])),
    )
    if isinstance(before, list) and isinstance(now, list):
        pairs = list(zip(before, now, strict=True))
        if len(set(map(str, pairs))) == 1:
            return f"each {before[0]} -> {now[0]}{tail}"
        if not any(isinstance(value, list) for value in before):
            moved = [f"{k}: {a} -> {b}" for k, (a, b) in enumerate(pairs, 1) if a != b]
            return f"{', '.join(moved)}{tail}"
    return f"{before} -> {now}{tail}"
