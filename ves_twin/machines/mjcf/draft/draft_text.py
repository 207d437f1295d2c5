"""draft_text: a machine's file as text, a line for each column, with the reason behind it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from ves_twin.core.units import SI_UNITS
from ves_twin.machines.mjcf.draft.check import Checked
from ves_twin.machines.mjcf.draft.chosen import RATES, Chosen
from ves_twin.machines.mjcf.draft.estimates import travel, two_digits, typical
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches
from ves_twin.machines.mjcf.draft.ranges import effects_line
from ves_twin.machines.mjcf.draft.spots import Quantity, is_damped_motor, servo_limit
from ves_twin.machines.mjcf.draft.toml_text import toml_text
from ves_twin.machines.mjcf.parts.servo import FILTERS, is_servo
from ves_twin.machines.mjcf.parts.ties import Follower, Ties
from ves_twin.machines.mjcf.rig.column import LAB_UNITS
from ves_twin.machines.mjcf.rig.description import Mode

SHARES = {
    "mass": ("5 %", "body_mass"),
    "damping": ("20 %", "dof_damping"),
    "frictionloss": ("20 %", "dof_frictionloss"),
    "armature": ("10 %", "dof_armature"),
    "stiffness": ("10 %", "jnt_stiffness"),
    "gain": ("1 %", "actuator_gainprm"),
}
"""Attribute -> share to which drawings and datasheets tell it, and where MuJoCo keeps it. Assumed:
scales and density tell masses to some per cent, motors their constant; friction varies most."""

OF_MODEL = "# shares of the model's values: yours? 100 % of one that is a guess"
"""Remark on them: a damping that nobody measured, known to 20 %, hides a dry friction (a crane)."""

BENT = 0.05
"""Share of a joint's typical speed that its first rows are off by where a force jumps in them: dry
friction of a balanced table (a test) made 0.03 rad/s of 0.3. The fit finds the speed itself."""

NOBODY_TELLS = "20 %"
"""Share to which loops inside a servo are known: no datasheet has them. Assumed."""

FITTED = "20 %"
"""Share to which a constant is known that was fitted beside friction: put the datasheet's there."""


def draft_text(
    name: str,
    given: Path,
    model_file: str,
    log: LogColumns,
    matches: Matches,
    check: Checked,
    mode: Chosen,
    model: mujoco.MjModel,
) -> str:
    """The file; `ves-twin` reads it as it stands."""
    head = [
        f"# Drafted by ves-twin new from {given.name} and {log.file}; # tells why",
        *(f"# look: {words}" for words in check.findings),
        *(f"# not used: {column}: {why}" for column, why in _unused(matches, check, mode)),
        "schema = 1",
        'kind = "rig"',
        f"name = {toml_text(name)}",
        f"model = {toml_text(model_file)}",
    ]
    if mode.mode is Mode.MOTION and mode.rate < RATES[1]:
        head.append(f"rate = {two_digits(mode.rate):g}   # Hz: {mode.rated}")
    head += [
        f"clock = {_clock(log)}",
        *([f"window = {_window(log)}"] if log.window else []),
        _drive(mode, check.locked),
        f"tolerances = {_tolerances(model, check)}   {OF_MODEL}",
        effects_line(check, model, log.period),
        "",
        "[signals]",
    ]
    lines = [*head, *_signals(check, mode, log)]
    needed = [m for m in check.found if m.spot.joint and m.spot.joint in mode.imposed]
    lines += ["", "[compare]   # what drives must give; no drive is fed in"] if needed else []
    lines += [
        f"{toml_text(signal_name(m, mode))} = {{ actuator = {toml_text(m.spot.name)} }}"
        for m in needed
    ]
    fitted = any(match.fitted for match in check.found)
    why = "   # efforts by the fitted scale: they change with it" if fitted else ""
    lines += ["", f"[typical.joint]{why}", *_joints(log, check, mode, model)]
    spans = list(_spans(log, check, mode))
    lines += ["", "[typical.signal]", *spans] if spans else []
    starts = list(_starts(log, check, mode)) if mode.mode is Mode.CONTROL else []
    lines += ["", "[start]", *starts] if starts else []
    return "\n".join(lines) + "\n"


def signal_name(match: Match, mode: Chosen) -> str:
    """What the signal of a column is called."""
    bare, quantity = re.sub(r"\W+", "_", match.spot.name), match.spot.quantity
    if integrated(match, mode):
        quantity = Quantity.POSITION
    return bare if quantity is Quantity.SENSOR else f"{bare}.{quantity.value}"


def integrated(match: Match, mode: Chosen) -> bool:
    """Whether a speed is integrated, and fed in as its joint's position."""
    return match.spot.quantity is Quantity.SPEED and match.spot.name in mode.integrated


def compared(match: Match, mode: Chosen) -> bool:
    """Whether the mode predicts it."""
    if match.spot.quantity is Quantity.SENSOR:
        return True
    if match.spot.quantity is Quantity.EFFORT and match.spot.joint in mode.imposed:
        return True
    if match.spot.name in mode.imposed:
        return False
    return (match.spot.quantity is Quantity.EFFORT) == (mode.mode is Mode.MOTION)


def used(match: Match, mode: Chosen) -> bool:
    """Whether the mode feeds it in or predicts it."""
    fed = mode.mode is Mode.MOTION or match.spot.name in mode.imposed
    speed = match.spot.quantity is Quantity.SPEED
    return not (fed and speed) or integrated(match, mode)


def _drive(mode: Chosen, locked: tuple[str, ...]) -> str:
    """What is fed in, and why."""
    keys = {"mode": toml_text(mode.mode), "smoothing": f"{two_digits(mode.smoothing):g}"}
    if mode.imposed:
        keys["imposed"] = toml_text(mode.imposed)
    if locked:
        keys["locked"] = toml_text(locked)
    if mode.horizon:
        keys["horizon"] = f"{mode.horizon:g}"
    text = ", ".join(f"{key} = {value}" for key, value in keys.items())
    return f"drive = {{ {text} }}   # {mode.why}"


def _unused(matches: Matches, check: Checked, mode: Chosen) -> Iterator[tuple[str, str]]:
    yield from matches.left.items()
    for column in matches.setpoints:
        if all(m.column != column for m in check.found):
            yield column, "what was asked for; [controllers] would feed it in"
    for match in check.found:
        if not used(match, mode):
            yield match.column, "a speed, where positions are fed in"


def _signals(check: Checked, mode: Chosen, log: LogColumns) -> Iterator[str]:
    """A line for each signal: where the model has it, unit, constant, noise."""
    sensors: dict[str, list[Match]] = {}
    for match in check.found:
        if match.spot.quantity is Quantity.SENSOR:
            sensors.setdefault(match.spot.name, []).append(match)
        elif used(match, mode):
            yield _signal([match], mode, log)
    for group in sensors.values():
        yield _signal(sorted(group, key=lambda m: m.spot.axis), mode, log)


def slower_of(found: Sequence[Match], mode: Chosen, log: LogColumns) -> list[str]:
    """Columns whose readings are repeated; what is fed in is held, and so no reading."""
    control = mode.mode is Mode.CONTROL
    fed = [
        m
        for m in found
        if control and m.spot.quantity is Quantity.EFFORT and m.spot.joint not in mode.imposed
    ]
    columns = (m.alone or m.column for m in found if m not in fed)
    return [column for column in columns if column in log.slower]


def _signal(group: list[Match], mode: Chosen, log: LogColumns) -> str:
    first = group[0]
    keys = {"columns": toml_text([m.column for m in group])}
    known = first.unit in SI_UNITS or first.unit in LAB_UNITS
    keys["unit"] = toml_text(first.unit if known and not first.indirect else first.spot.unit)
    if first.scale != 1.0:
        keys["scale"] = f"{first.scale:g}"
    own = first.zero * first.scale / first.factor  # in the column's unit, as homes are
    zero = mode.homes[first.column][0] if first.column in mode.homes else own
    if zero:
        keys["offset"] = f"{zero:.7g}"
    slower = [log.slower[c].repeats for c in slower_of(group, mode, log)]
    keys |= {"repeats": f"{max(slower)}"} if slower else {}
    keys |= _place(group, mode)
    if first.spot.joint and first.spot.joint in mode.imposed:
        del keys["actuator"]  # [compare] says it: here it would be fed in
    reasons = list(first.reasons) + ([] if first.told else [f"unit {first.unit} is a guess"])
    if first.column in mode.homes:
        reasons.append(mode.homes[first.column][1])
    if compared(first, mode):
        keys["noise"] = f"{max(mode.noise[m.column][0] for m in group):.2g}"
        reasons.append(f"noise: {mode.noise[first.column][1]}")
    if first.fitted and "noise" in keys:
        reasons.append(
            "another scale changes noise by its factor; tolerances.gain says how well you know it"
        )
    text = ", ".join(f"{key} = {value}" for key, value in keys.items())
    why = "; ".join([", ".join(reasons), *first.others])
    return f"{toml_text(signal_name(first, mode))} = {{ {text} }}   # {why}"


def _place(group: list[Match], mode: Chosen) -> dict[str, str]:
    """Keys of where the model has a signal."""
    spot = group[0].spot
    if spot.quantity in (Quantity.POSITION, Quantity.SPEED):
        keys = {"joint": toml_text(spot.name)}
        if integrated(group[0], mode):
            return {**keys, "integrated": "true"}
        speed = spot.quantity is Quantity.SPEED
        return {**keys, "of": toml_text("speed")} if speed else keys
    kind = "actuator" if spot.quantity is Quantity.EFFORT else "sensor"
    axis = {"axis": toml_text("xyz"[spot.axis])} if len(group) < spot.width else {}
    return {kind: toml_text(spot.name), **axis}


def _joints(log: LogColumns, check: Checked, mode: Chosen, model: mujoco.MjModel) -> Iterator[str]:
    """Typical effort, speed and travel of each joint that was recorded, behind its gear."""
    efforts = {m.spot.joint: m for m in check.found if m.spot.quantity is Quantity.EFFORT}
    placed = {m.spot.name for m in check.found if m.spot.quantity is Quantity.POSITION}
    told = dict[str, dict[str, float]]()
    for match in check.found:
        if match.spot.quantity is Quantity.POSITION:
            position = match.factor * log.column(match.column)
            speed = _speed(log, match, check.corner)
        elif match.spot.quantity is Quantity.SPEED and match.spot.name not in placed:
            rate = match.factor * log.column(match.column)
            position, speed = log.period * np.cumsum(rate), typical(rate)
        else:
            continue
        sizes = {"speed": speed, "travel": travel(position)}
        own = efforts.get(match.spot.name)
        if own is not None and is_damped_motor(model, model.actuator(own.spot.name).id):
            sizes = {"effort": _given(log, own, model), **sizes}
        elif own is not None and (most := servo_limit(model, own.spot.name)):
            sizes = {"effort": most, **sizes}  # what it gives is not logged, and may be all it has
        elif check.motion is not None:
            steady = check.motion.steady[:, check.dofs[match.spot.name]]
            sizes = {"effort": typical(steady), **sizes}
        as_moved = mode.typical.get(match.spot.name, {})
        why = "   # effort as the model moves: no column tells it" * bool(as_moved)
        text = ", ".join(f"{k} = {v:g}" for k, v in {**as_moved, **sizes}.items() if v > 0.0)
        yield f"{_key(match.spot.name)} = {{ {text} }}{why}"
        told[match.spot.name] = sizes
    for one in Ties.of(model, told).followers:
        ratio, leader = abs(one.powers[1]), told[one.leader]
        told[one.joint] = {key: ratio * leader[key] for key in ("speed", "travel")}
        yield from _pushed(one, efforts, told[one.joint], log, model)
    for joint, given in mode.typical.items():
        if joint in told:
            continue
        text = ", ".join(f"{k} = {v:g}" for k, v in given.items())
        yield f"{_key(joint)} = {{ {text} }}   # as the model moves: no column tells it"


def _pushed(
    follower: Follower,
    efforts: Mapping[str, Match],
    moved: Mapping[str, float],
    log: LogColumns,
    model: mujoco.MjModel,
) -> Iterator[str]:
    """A line for a joint that follows a measured one, where its own motor is logged."""
    if follower.joint in efforts:
        sizes = {"effort": _given(log, efforts[follower.joint], model), **moved}
        text = ", ".join(f"{k} = {v:g}" for k, v in sizes.items() if v > 0.0)
        yield f"{_key(follower.joint)} = {{ {text} }}   # as it follows {follower.leader}"


def _given(log: LogColumns, effort: Match, model: mujoco.MjModel) -> float:
    """Typical effort of a motor at its joint."""
    drive = model.actuator(effort.spot.name)
    gain = abs(float(drive.gear[0] * drive.gainprm[0])) or 1.0
    return typical(gain * effort.factor * log.column(effort.column))


def _speed(log: LogColumns, position: Match, corner: float) -> float:
    """Typical speed of a joint whose position was recorded."""
    values = position.factor * log.smooth(position.column, corner)
    return typical(np.gradient(values, log.period))


def _spans(log: LogColumns, check: Checked, mode: Chosen) -> Iterator[str]:
    """Typical range of sensors; that of a joint's signals follows from the joint."""
    groups: dict[str, float] = {}
    for match in check.found:
        if match.spot.quantity is Quantity.SENSOR:
            size = travel(match.factor * log.column(match.column))
            name = signal_name(match, mode)
            groups[name] = max(groups.get(name, 0.0), size)
    for name, size in groups.items():
        yield f"{toml_text(name)} = {{ span = {size:g} }}"


def _starts(log: LogColumns, check: Checked, mode: Chosen) -> Iterator[str]:
    """Read off the first rows: position to its noise, speed to that behind the low-pass.

    Where pieces begin in motion, speed to a share of the typical one: a force that jumps bends the
    first rows. Of a joint whose speed alone is recorded the speed to its noise.
    """
    placed = {m.spot.name for m in check.found if m.spot.quantity is Quantity.POSITION}
    for match in check.found:
        if match.spot.quantity is Quantity.SPEED and match.spot.name not in placed:
            sd = mode.noise[match.column][0]
            yield f'{_key(match.spot.name)} = {{ position = "measured", speed_sd = {sd:.2g} }}'
        if match.spot.quantity is Quantity.POSITION and match.spot.name not in mode.imposed:
            sd = mode.noise[match.column][0]
            speed = 2.0 * np.pi * mode.smoothing * sd
            if mode.horizon:
                speed = max(speed, BENT * _speed(log, match, check.corner))
            text = f'position = "measured", sd = {sd:.2g}, speed_sd = {speed:.2g}'
            yield f"{_key(match.spot.name)} = {{ {text} }}"


def _clock(log: LogColumns) -> str:
    if not log.clock:
        return f"{{ rate = {1.0 / log.period:.8g} }}"
    scale = f", scale = {log.scale:g}" if log.scale != 1.0 else ""
    return f"{{ column = {toml_text(log.clock)}{scale} }}"


def _window(log: LogColumns) -> str:
    start, stop = log.window or (0.0, 0.0)
    return f"{{ start = {start:.9g}, stop = {stop + 0.5 * log.period:.9g} }}   # elsewhere empty"


def _tolerances(model: mujoco.MjModel, check: Checked) -> str:
    """Of the attributes that the model has; a constant that was fitted is known badly."""
    there = {
        attribute: share
        for attribute, (share, field) in SHARES.items()
        if np.any(np.asarray(getattr(model, field)) != 0.0)
    }
    drives = range(model.nu)
    servos = [i for i in drives if is_servo(model, i)]
    if len(servos) == model.nu:
        there.pop("gain", None)
    if servos:
        there["kp"] = NOBODY_TELLS
    if any(model.actuator_biasprm[i, 2] for i in servos):
        there["kv"] = NOBODY_TELLS
    if any(int(model.actuator_dyntype[i]) in FILTERS for i in drives):
        there["timeconst"] = NOBODY_TELLS
    efforts = [match for match in check.found if match.spot.quantity is Quantity.EFFORT]
    if any(match.fitted or (match.spot.unit == "1" and not match.told) for match in efforts):
        there["gain"] = FITTED  # counts or a duty: nobody tells that the model's constant is theirs
    return "{ " + ", ".join(f'{name} = "{share}"' for name, share in there.items()) + " }"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else toml_text(name)
