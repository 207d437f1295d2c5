"""other_way: columns that fit a model better turned, or in another unit: simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from ves_twin.core.recording.recording import Recording
from ves_twin.machines.mjcf.draft.predicted import least_explained
from ves_twin.machines.mjcf.draft.spots import HINGE
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.servo import is_servo
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

SHARES = (0.02, 0.1, 0.3, 0.6, 1.0)
"""Dry friction that is tried, as shares of a drive's mean effort; FINER more about the best."""

FINER = 8

LOST = 1e6
"""Share that stands for a simulation that diverges."""

UNITS = (0.01, 0.1, 10.0, 100.0)
"""What a command is multiplied with besides: a gear that the model has, too, per cent, mN m."""


def other_way(rig: Rig, recording: Recording) -> tuple[list[str], bool]:
    """A question about the column that, turned or scaled, lets the model explain most more.

    Of a motion that is integrated signs and units are not told by efforts: the model is simulated
    with each joint's readings, measured or imposed, and with each command, otherwise.

    Dry friction at the joints that are driven is tried as well, and asked after beside: of a worm
    drive in order a tenth of its torque explained 84 %, its damping in the place of its friction.

    Args:
        rig: a drafted machine whose commands are fed in.
        recording: of its log.

    Returns:
        A sentence, two where friction explains more as well; none where nothing is worth one. Then
        whether friction explains as much as any column read otherwise.
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
        return [], False
    tried = [(names, -1.0) for names in (*joints.values(), *commands)]
    hinges = [j for j in joints if int(rig.model.joint(j).type[0]) == HINGE]
    tried += [(joints[j], factor) for j in hinges for factor in (DEGREE, 1.0 / DEGREE)]
    tried += [(names, factor) for names in commands for factor in UNITS]
    one = len(MjcfForward.of(rig).channels) == 1
    of = "of it" if one else "of each signal"
    least = "" if one else "at least "
    within = f"in pieces of {told.drive.horizon:g} s " if told.drive.horizon else ""
    before, found = max(least_explained(rig, recording), 0.0), list[tuple[float, str]]()
    for names, factor in tried:
        signals = {n: factor * v if n in names else v for n, v in recording.signals.items()}
        share = least_explained(rig, replace(recording, signals=signals))
        explains = f"{within}the model explains {least}{share:.0%} {of}, {before:.0%}"
        other = f"times {factor:g}, {{}}: another unit, or a gear?"
        question = QUESTIONS.get(factor, other).format(f"{explains} as it is")
        found.append((share, f"{names[0]} {question}"))
    share, sentence = max(found)
    asked = [sentence] if share > before + BETTER else []
    rubbed, rubbing = _rubbed(rig, recording)
    if rubbed > before + BETTER:
        where = ", ".join(rubbing)
        words = f"{within}with dry friction at {where} the model explains {least}{rubbed:.0%} {of}"
        asked.insert(0, f"{words}, {before:.0%} as it is: a diagnosis looks for it")
    rubs = rubbed > before + BETTER and rubbed >= share
    return (asked if len(asked) < 2 or rubs else asked[::-1]), rubs


def _rubbed(rig: Rig, recording: Recording) -> tuple[float, list[str]]:
    """What the model explains with dry friction at all joints that are driven, and those joints.

    Of each the same share of the mean effort of its drive, of which rests are no part; the share
    that explains most.
    """
    forward, most = MjcfForward.of(rig), dict[str, float]()
    known = {parameter.name for parameter in forward.parameters}
    for actuator, signal in rig.description.drive.actuators.items():
        command = np.abs(np.nan_to_num(recording[signal]))
        mean = float(np.sum(command**2) / max(float(np.sum(command)), 1e-30))
        if is_servo(rig.model, int(rig.model.actuator(actuator).id)):
            continue
        for joint, arm in arms_of(rig.model, actuator).items():
            if f"coulomb_friction@{joint}:level" in known and abs(arm) * mean > 0.0:
                most[joint] = most.get(joint, 0.0) + abs(arm) * mean

    def left(share: float) -> float:
        levels = {f"coulomb_friction@{joint}:level": share * one for joint, one in most.items()}
        return min(1.0 - least_explained(rig, recording, levels), LOST)

    if not most:
        return -np.inf, []
    every = [left(share) for share in SHARES]
    n = int(np.argmin(every))
    bounds = (SHARES[max(n - 1, 0)], SHARES[min(n + 1, len(SHARES) - 1)])
    found = minimize_scalar(left, bounds=bounds, options={"maxiter": FINER})
    return 1.0 - min(float(found.fun), every[n]), list(most)
