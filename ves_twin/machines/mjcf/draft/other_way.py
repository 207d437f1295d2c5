"""other_way: columns that fit a model better turned, or in another unit: simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from ves_twin.core.recording.recording import Recording
from ves_twin.machines.mjcf.draft.predicted import least_explained
from ves_twin.machines.mjcf.draft.spots import HINGE
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.transmission import arms_of

BETTER = 0.3
"""Share of a signal's power by which the other sign must explain more. Assumed: of a swing about
its rest both explain the same, and a sign that is wrong explains nothing."""

MOST = 6
"""Columns that are tried: each costs a simulation."""

DEGREE = np.pi / 180.0
"""In radians."""

QUESTIONS = {
    -1.0: "turned, {}: does it count the other way?",
    DEGREE: "times pi/180, {}: is it in degrees?",
    1.0 / DEGREE: "times 180/pi, {}: is it in radians?",
}
"""What a reading is multiplied with, and what is asked where that fits better."""

TRIED = 15
"""Levels of dry friction that are tried at a joint: each costs a simulation."""

AS_GOOD = 0.1
"""Share of a signal's power by which a unit may explain more than dry friction, which is likelier:
of a worm drive in order 84 % was explained by a tenth of its torque, its damping for its friction,
and that was asked after."""

UNITS = (0.01, 0.1, 10.0, 100.0)
"""What a command is multiplied with besides: a gear that the model has, too, per cent, mN m."""


def other_way(rig: Rig, recording: Recording) -> list[str]:
    """A question about the column that, turned or scaled, lets the model explain most more.

    Of a motion that is integrated signs and units are not told by efforts: the model is simulated
    with each joint's readings, measured or imposed, and with each command, otherwise.

    Args:
        rig: a drafted machine whose commands are fed in.
        recording: of its log.

    Returns:
        One sentence; none where no column is worth a question.
    """
    told = rig.description
    joints: dict[str, list[str]] = {}
    for name, compared in told.compare.items():
        if compared.joint and compared.of in ("position", "speed"):
            joints.setdefault(compared.joint, []).append(name)
    for joint, signal in MjcfForward.of(rig).imposed.items():
        joints.setdefault(joint, []).append(signal)
    commands = [[name] for name in told.drive.actuators.values()]
    if not 0 < len(joints) + len(commands) <= MOST:
        return []
    tried = [(names, -1.0) for names in (*joints.values(), *commands)]
    hinges = [j for j in joints if int(rig.model.joint(j).type[0]) == HINGE]
    tried += [(joints[j], factor) for j in hinges for factor in (DEGREE, 1.0 / DEGREE)]
    tried += [(names, factor) for names in commands for factor in UNITS]
    one = len(MjcfForward.of(rig).channels) == 1
    of = "of it" if one else "of what it explains least of"
    within = f"in pieces of {told.drive.horizon:g} s " if told.drive.horizon else ""
    before, found = max(least_explained(rig, recording), 0.0), list[tuple[float, str]]()
    for names, factor in tried:
        signals = {n: factor * v if n in names else v for n, v in recording.signals.items()}
        share = least_explained(rig, replace(recording, signals=signals))
        explains = f"{within}the model explains {share:.0%} {of}, {before:.0%}"
        other = f"times {factor:g}, {{}}: another unit, or a gear?"
        question = QUESTIONS.get(factor, other).format(f"{explains} as it is")
        found.append((share, f"{names[0]} {question}"))
    share, sentence = max(found)
    rubbed, joint = _rubbed(rig, recording)
    if max(rubbed, share) <= before + BETTER:
        return []
    rubs = f"with dry friction at {joint} the model explains {rubbed:.0%} {of}"
    if rubbed > share - AS_GOOD:
        return [f"{within}{rubs}, {before:.0%} as it is: a diagnosis looks for it"]
    return [f"{sentence} Or is it friction: {rubs}" if rubbed > before + BETTER else sentence]


def _rubbed(rig: Rig, recording: Recording) -> tuple[float, str]:
    """What the model explains with dry friction at the joint where it helps most, and that joint.

    Of the level that explains most, up to the mean effort of its drive; rests do not count for it.
    """
    forward, found = MjcfForward.of(rig), [(-np.inf, "")]
    known = {parameter.name for parameter in forward.parameters}
    for actuator, signal in rig.description.drive.actuators.items():
        command = np.abs(np.nan_to_num(recording[signal]))
        mean = float(np.sum(command**2) / max(float(np.sum(command)), 1e-30))
        for joint, arm in arms_of(rig.model, actuator).items():
            name = f"coulomb_friction@{joint}:level"
            if name not in known or not abs(arm) * mean > 0.0:
                continue

            def left(share: float, name: str = name, most: float = abs(arm) * mean) -> float:
                return 1.0 - least_explained(rig, recording, {name: share * most})

            at = minimize_scalar(left, bounds=(0.0, 1.0), options={"maxiter": TRIED})
            found.append((1.0 - float(at.fun), joint))
    return max(found)
