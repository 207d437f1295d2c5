"""as_commanded: columns with a constant taken as the model's own commands, not by a fitted one."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.machines.mjcf.draft.check import Checked


def as_commanded(check: Checked) -> Checked | None:
    """Matches whose fitted constants are those of the model; None where there is none to change.

    A constant that inverse dynamics fits has the error of the model's inertia in it: of a motor
    whose armature is four times too small it came out at 0.31, and the model explains more of the
    motion with 1. Where a model is driven by what the column tells (its control has no unit, as
    volts with a gear), that is the other choice.
    """
    fitted = {m.column: m for m in check.found if m.fitted and m.spot.unit == "1"}
    if not fitted:
        return None
    found = tuple(replace(m, scale=m.prefix) if m.column in fitted else m for m in check.found)
    findings = [
        words
        for words in check.findings
        if not any(words.startswith(f"{name} is {m.kind}") for name, m in fitted.items())
    ]
    findings += [
        f"{name} is taken as the command of {m.spot.label} as the model has it: simulated, that"
        f" explains more than {m.scale:.3g} times it, which inverse dynamics fits with the model's"
        " inertia: is that right?"
        for name, m in fitted.items()
    ]
    return replace(check, found=found, findings=tuple(findings))
