"""one_way_twins: constant forces and frictions that are one where a joint does not turn round."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.model.directional import Moment, Visited
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.joints import CoulombFriction
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.motion.work import SMOOTH
from ves_twin.machines.mjcf.rig.machine import Rig

MOVING = 0.02
"""Share of a joint's fastest speed in a recording from which a row counts as motion."""

STANDING = 0.005
"""The same of its fastest speed in any, below which it stands: what the noise of a standing encoder
leaves of a smoothed speed was 0.2 % at a youBot's arm."""

CONSTANT = 0.1
"""Share of the square of an effort along a motion up to which a constant stands for it. Chosen so
that Coulomb friction of a joint that reverses in 3 % of its moving rows (4 x 3 % x 97 %) is told
from an offset, as its jump is seen there."""

MORE = 1.5
"""Times the model's dry friction that a force may be which stands for less of it: an interval's
width, assumed."""

TWINS = {"force_offset": "coulomb_friction", "viscous_asymmetry": "viscous_friction"}
"""What a kind is in one direction; any other one whose effort is constant is a force offset."""

Path = tuple[Mapping[str, FloatArray], Mapping[str, float]]
"""What moves along a recording (n,), by name, and the values of parameters in it."""


def one_way_twins(
    rig: Rig, labels: Sequence[str], moments: Sequence[Moment], visited: Visited
) -> Mapping[str, tuple[str, ...]]:
    """Of each cause of a joint that moves one way alone what nothing tells it from.

    Where a joint stands dry friction holds any force up to its level: such rows tell nothing.
    """
    moments = [(programme, values) for programme, values in moments if not programme.poses]
    asked = [effect for effect in _effects(rig, moments) if _label(effect) in labels]
    if not asked:
        return {}
    paths = [(visited(programme, values), values) for programme, values in moments]
    paths = [(path, values) for path, values in paths if path]  # none where a limit is at work
    found = {_label(effect): _twin(rig, effect, paths) for effect in asked}
    return {label: (twin,) for label, twin in found.items() if twin}


def _label(effect: Effect) -> str:
    return f"{effect.kind}@{effect.target}"


def _effects(rig: Rig, moments: Sequence[Moment]) -> list[Effect]:
    """Effects of joints at work in the first recording: all have the same ones."""
    at_work = rig.effects_at(moments[0][1]) if moments else ()
    return [effect for effect, _ in at_work if effect.element is Element.JOINT]


def _twin(rig: Rig, effect: Effect, paths: Sequence[Path]) -> str:
    """The label of what an effect is along a motion in one direction; empty if it is not."""
    joint = effect.parts[0]
    speeds = [path.get(f"speed@{joint}", np.zeros(0)) for path, _ in paths]
    fastest = max((float(np.max(np.abs(s), initial=0.0)) for s in speeds), default=0.0)
    if fastest == 0.0:
        return ""
    moving = [_moves(speed, fastest) for speed in speeds]
    if not _is_constant([np.sign(speed) for speed in speeds], moving):
        return ""
    efforts = [_effort(rig, _label(effect), *path) for path in paths]
    if effect.kind == "force_offset" and _pushes(efforts, speeds):
        level = CoulombFriction(joint).present(rig.model)  # of which there may be less
        size = np.mean([float(np.mean(np.abs(effort))) for effort in efforts])
        return f"coulomb_friction@{joint}" if 0.0 < size < MORE * level else ""
    if effect.kind in TWINS:
        return f"{TWINS[effect.kind]}@{joint}"
    return f"force_offset@{joint}" if _is_constant(efforts, moving) else ""


def _moves(speed: FloatArray, fastest: float) -> BoolArray:
    """Rows (n,) in which a joint moves, of a recording that may be slower than others."""
    own = float(np.max(np.abs(speed), initial=0.0))
    return np.asarray(np.abs(speed) > max(MOVING * own, STANDING * fastest))


def _pushes(efforts: Sequence[FloatArray], speeds: Sequence[FloatArray]) -> bool:
    """Whether efforts against a joint (n,) of recordings put energy into it."""
    return sum(float(np.vdot(e, v)) for e, v in zip(efforts, speeds, strict=True)) < 0.0


def _is_constant(efforts: Sequence[FloatArray], rows: Sequence[BoolArray]) -> bool:
    """Whether a constant stands for efforts (n,) of recordings in some of their rows."""
    every = np.concatenate([e[kept] for e, kept in zip(efforts, rows, strict=True)])
    square = float(np.mean(np.square(every))) if len(every) else 0.0
    return square > 0.0 and float(np.var(every)) < CONSTANT * square


def _effort(
    rig: Rig, label: str, path: Mapping[str, FloatArray], values: Mapping[str, float]
) -> FloatArray:
    """An effect's effort against its joint along a recording (n,), under a load that stays."""
    for effect, place in rig.effects_at(values):
        if _label(effect) == label:
            return _against(effect, place, path)
    return np.zeros_like(path["time"])


def _against(effect: Effect, place: Place, path: Mapping[str, FloatArray]) -> FloatArray:
    joint = effect.parts[0]
    position, speed = path[f"position@{joint}"], path[f"speed@{joint}"]
    if isinstance(effect, CoulombFriction):  # of the model, not of a resistance beside it
        return np.sign(speed)
    slow, load = SMOOTH * place.speed, np.ones_like(speed)
    effort = effect.resist(speed, slow) + effect.hold(position) + effect.carry(load, speed, slow)
    return np.asarray(effort)
