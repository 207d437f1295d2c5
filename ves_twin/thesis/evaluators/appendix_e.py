"""APPENDIX_E: the operators' rules, each by a run in which it is kept or broken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ves_twin.core.errors import UnreachableError
from ves_twin.core.recording.recording import Recording
from ves_twin.plant.laboratory import Laboratory
from ves_twin.plant.statics import check_reach
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context, Run
from ves_twin.thesis.evaluation import Answer, Evaluation
from ves_twin.thesis.evaluators.chapter_2 import WHOLE_TICKS, model_rates

PARKED = "release_table_5_2"
MOVING, POWER, CEILING = "operation_panic", "operation_crate_power", "operation_ceiling"
READERS, RECOVERY = "operation_two_readers", "operation_recovery"
EMULATION = "beam_horizontal_truth"

COAST = 0.5
"""Time after a freeze in which the platform may come to rest on the spring of its oil [s]."""

STANDS = 2e-5
"""How far a platform that stands still may move [m, rad]: ten counts of a leg's transducer."""

HELD_ARM = 1e-3
"""How far a braked joint may move [rad]: the engine's dry friction is slightly soft."""

FALLEN = np.radians(10.0)
"""A joint that has turned so far in half a second has neither drive nor brake [rad]."""

Script = Sequence[tuple[float, str]]
"""What operators do: time [s] and action."""

PANICS: Mapping[str, tuple[str, Script]] = {
    "run": ("run", ((1.0, "press_panic"),)),
    "idle": ("idle", ((0.5, "press_panic"),)),
    "home": ("run", ((0.8, "home"), (1.2, "press_panic"))),
    "start": (
        "freeze",
        ((0.1, "release_panic"), (0.2, "start_platform"), (0.7, "press_panic")),
    ),
    "locked up": (
        "run",
        ((0.5, "clear_active_flag"), (0.6, "read_sensor"), (1.0, "press_panic")),
    ),
}
"""State in which the button is pressed -> how the run begins, and what leads there."""


def _operated(context: Context, scenario: str, begin: str, script: Script, duration: float) -> Run:
    changes: dict[str, object] = {
        "run.duration": duration,
        "operation.begin": begin,
        "operation.actions": [{"at": at, "action": action} for at, action in script],
    }
    return context.run(scenario, changes)


def _said(run: Recording, kind: str = "operation") -> list[str]:
    return [event.message for event in run.info.events if event.kind == kind]


def _states(run: Recording) -> list[str]:
    """States in the order in which they were reached."""
    changes = [message.split(":")[0] for message in _said(run) if "->" in message]
    return [change.split(" -> ")[1] for change in changes]


def _moved(run: Recording, begin: float, end: float = np.inf) -> float:
    """Largest movement of the platform in a stretch of time, any axis [m, rad]."""
    poses = run.window(begin, end)["truth.pose"]
    return float(np.max(np.ptp(poses, axis=0))) if len(poses) else float("nan")


def _panic(context: Context, claim: Claim) -> Evaluation:
    runs, frozen, worst = [], True, 0.0
    for begin, script in PANICS.values():
        pressed = script[-1][0]
        run = _operated(context, MOVING, begin, script, pressed + 1.2)
        runs.append(run.command)
        last = [event for event in run.recording.info.events if "panic button" in event.message]
        cycle = run.recording.info.period
        at_once = bool(last) and last[-1].time <= pressed + cycle + 1e-9
        off = not np.any(run.recording.window(pressed + 2.0 * cycle, np.inf)["valve.command"])
        frozen = frozen and _states(run.recording)[-1:] == ["freeze"] and at_once and off
        worst = max(worst, _moved(run.recording, pressed + COAST))
    note = (
        f"pressed in {', '.join(PANICS)}: valves without current within a cycle; {COAST:g} s later"
        f" the platform moves by {worst * 1e6:.1f} um or urad at most"
    )
    return Evaluation(holds=frozen and worst < STANDS, note=note, runs=tuple(runs))


def _crate_power(context: Context, claim: Claim) -> Evaluation:
    wrong = _operated(context, POWER, "run", ((0.5, "crate_off"),), 1.0)
    right = _operated(context, POWER, "run", ((0.5, "press_arm_panic"), (0.7, "crate_off")), 1.2)
    fall, sag = (
        float(np.max(np.ptp(run.recording.window(0.45, np.inf)["truth.arm_q"], axis=0)))
        for run in (wrong, right)
    )
    warned = bool(_said(wrong.recording, "arm_falls"))
    quiet = not _said(right.recording, "arm_falls")
    note = (
        f"half a second after the cut joint 2 has turned by {np.degrees(fall):.0f} deg and the log"
        f" says so; after the button by {np.degrees(sag):.3f} deg"
    )
    holds = warned and quiet and fall > FALLEN and sag < HELD_ARM
    return Evaluation(holds=holds, note=note, runs=(wrong.command, right.command))


def _ceiling(context: Context, claim: Claim) -> Evaluation:
    runs = [
        context.run(CEILING, {"run.duration": 6.5, "arm.start": ["180 deg", f"{q2} deg", 0.0]})
        for q2 in (90, 0, 180)
    ]
    ends = [run.recording.info.outcome for run in runs]
    clear = all("at home" in _said(run.recording) for run in runs[1:])
    note = (
        "no interlock: from sleep to home with q2 = 90 deg the arm reaches the ceiling"
        f" ({ends[0]}); with q2 = 0 and 180 deg the platform"
        f" {'gets' if clear else 'does not get'} home"
        f" (ceiling of {Laboratory.load().ceiling:g} m assumed)"
    )
    holds = clear and ends == [Outcome.CEILING, Outcome.COMPLETED, Outcome.COMPLETED]
    return Evaluation(holds=holds, note=note, runs=tuple(run.command for run in runs))


def _self_test(context: Context, claim: Claim) -> Evaluation:
    run = _operated(context, MOVING, "sleep", ((0.2, "start_platform"),), 0.4)
    said = "; ".join(_said(run.recording, "refused"))
    both = "pressure is too low" in said and "panic button is pressed" in said
    stays = not _states(run.recording)
    return Evaluation(holds=both and stays, note=f"refused: {said or '-'}", runs=(run.command,))


def _switched_on(context: Context, claim: Claim) -> Evaluation:
    """The platform where its legs are switched on: frozen off home, and asleep."""
    up: Script = ((0.1, "start_pump"), (1.5, "release_panic"), (1.6, "start_platform"))
    asleep = _operated(context, MOVING, "sleep", up, 2.6)
    again: Script = (
        (0.8, "press_panic"),
        (1.5, "release_panic"),
        (1.6, "start_platform"),
    )
    frozen = _operated(context, MOVING, "run", again, 2.6)
    moved = [_moved(run.recording, 1.55) for run in (asleep, frozen)]
    started = all("start" in _states(run.recording) for run in (asleep, frozen))
    note = (
        f"from sleep {moved[0] * 1e3:.2g} mm, from a freeze off home {moved[1] * 1e3:.2g} mm in"
        " the second that a start is watched, the largest axis"
    )
    return Evaluation(
        (max(moved),), holds=started, note=note, runs=(asleep.command, frozen.command)
    )


def _second_reader(context: Context, claim: Claim) -> Evaluation:
    unflagged = _operated(
        context, READERS, "run", ((0.5, "clear_active_flag"), (0.6, "read_sensor")), 1.0
    )
    flagged = _operated(context, READERS, "run", ((0.6, "read_sensor"),), 1.0)
    locked = _said(unflagged.recording, "lock_up")
    shared = any("shared memory" in message for message in _said(flagged.recording))
    dead = _command_moves(unflagged.recording, 0.65) == 0.0
    alive = _command_moves(flagged.recording, 0.65) > 0.0
    note = (
        "a second reader is not refused, it locks both computers up and the platform gets no"
        " command any more; with platActive set it reads from shared memory and nothing happens"
    )
    holds = bool(locked) and shared and dead and alive and not _said(flagged.recording, "lock_up")
    return Evaluation(holds=holds, note=note, runs=(unflagged.command, flagged.command))


def _command_moves(run: Recording, begin: float, end: float = np.inf) -> float:
    return float(np.max(np.ptp(run.window(begin, end)["platform.command"], axis=0)))


def _waits(context: Context, claim: Claim) -> Evaluation:
    signal = 1.0
    run = _operated(context, EMULATION, "home", ((signal, "run"),), 3.0)
    cycle = run.recording.info.period
    before = _command_moves(run.recording, 0.0, signal - 0.5 * cycle)
    after = _command_moves(run.recording, signal)
    moved = _moved(run.recording, 0.0, signal - 0.5 * cycle)
    note = (
        f"micro_gravity at home, signal after {signal:g} s: the command moves by"
        f" {before * 1e3:g} mm or mrad before it and by {after * 1e3:.1f} in the 2 s after it;"
        f" the platform by {moved * 1e6:.1f} um before it"
    )
    holds = before == 0.0 and moved < STANDS and after > 0.0
    return Evaluation(holds=holds, note=note, runs=(run.command,))


def _shut_down(context: Context, claim: Claim) -> Evaluation:
    run = _operated(context, MOVING, "run", ((1.0, "sleep"),), 5.5)
    recording, travel = run.recording, Laboratory.load().sleep_travel
    reached = _states(recording)
    ramps = [event.time for event in recording.info.events if event.message == "ramp to sleep"]
    home = context.plant.geometry.lengths(np.zeros(6))
    off = [float("nan")] * 2
    if ramps:
        turn = recording.window(ramps[0], np.inf)["leg.length"][0]
        ends = recording["leg.length"][-1] + travel
        off = [float(np.max(np.abs(lengths - home))) for lengths in (turn, ends)]
    note = (
        f"sleep asked in a motion: {', '.join(reached)}; legs {off[0] * 1e3:.1f} mm off home where"
        f" the way down begins, {off[1] * 1e3:.1f} mm off sleep ({travel:g} m in) at the end"
    )
    holds = reached == ["home", "sleep"] and max(off) < 0.01
    return Evaluation(holds=holds, note=note, runs=(run.command,))


def _recovery(context: Context, claim: Claim) -> Evaluation:
    run = context.run(RECOVERY, {"run.duration": 9.5})
    reached, refused = _states(run.recording), _said(run.recording, "refused")
    early = any("panic button is pressed" in message for message in refused)
    unready = any("program does not run" in message for message in refused)
    note = (
        f"{', '.join(reached)}; refused before: start with the button pressed, sleep without a"
        " program"
    )
    order = ["freeze", "start", "idle", "home", "sleep"]
    return Evaluation(holds=reached == order and early and unready, note=note, runs=(run.command,))


def _rates(context: Context, claim: Claim) -> Evaluation:
    return Evaluation(model_rates(context), note=f"set to 85, 80, 75; {WHOLE_TICKS}")


def _low_home(context: Context, claim: Claim) -> Evaluation:
    number, geometry = context.plant.parameters.number, context.plant.geometry
    travel = number("leg.stroke") / 2.0 - number("leg.margin")
    pose = np.array([0.0, 0.0, -0.15, 0.0, 0.0, 0.0])
    need = float(np.max(np.abs(geometry.lengths(pose) - geometry.lengths(np.zeros(6)))))
    try:
        check_reach(geometry, pose, travel, "home with Z offset")
    except UnreachableError as error:
        return Evaluation(holds=False, note=str(error))
    return Evaluation(holds=True, note=f"legs move {need:.3f} of {travel:.3f} m")


def _parking(context: Context, claim: Claim) -> Evaluation:
    angles = np.degrees(Scenario.load(PARKED).arm.start)
    return Evaluation(tuple(map(float, angles)), note=f"start of {PARKED}")


APPENDIX_E: Mapping[str, Answer] = {
    "C116": _panic,
    "C117": _crate_power,
    "C118": _ceiling,
    "C119": _self_test,
    "C120": _switched_on,
    "C121": _second_reader,
    "C123": _rates,
    "C124": _waits,
    "C125": _low_home,
    "C126": _shut_down,
    "C127": _parking,
    "C128": _recovery,
}
"""Claim -> answer; C122, zeroing, stands with the sensor's."""
