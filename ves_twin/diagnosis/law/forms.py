"""FORMS: closed forms that the field knows, by what they depend on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray

SHARP = 0.002
"""Width of a sign or a step as a share of the range seen: below what knots resolve."""

Function = Callable[..., FloatArray]


@dataclass(frozen=True)
class Form:
    """a g(x; inner numbers).

    Attributes:
        name: for people, the field's term.
        formula: with x for the variable and p, q for inner numbers.
        at: g(x, w, *inner): of the variable as it is, the width of its range, inner numbers.
        starts: inner numbers to begin at, as shares of the range from its low end; () for none.
        spread: prior sd of each inner number, as a share of the range.
        relative: whether an inner number is a place in the range, and not a width.
    """

    name: str
    formula: str
    at: Function
    starts: tuple[tuple[float, ...], ...] = ((),)
    spread: tuple[float, ...] = ()
    relative: bool = True

    def __reduce__(self) -> tuple[Callable[[str], Form], tuple[str]]:
        return form_named, (self.name,)  # a function of this page has no name that travels


def form_named(name: str) -> Form:
    """The form of the dictionary, or the tone, that has this name."""
    every = (TONE, *(form for forms in FORMS.values() for form in forms))
    return next(form for form in every if form.name == name)


def _steps(count: int) -> tuple[tuple[float, ...], ...]:
    return tuple((float(s),) for s in np.linspace(0.0, 1.0, count + 2)[1:-1])


def _up(x: FloatArray) -> FloatArray:
    return np.maximum(x, 0.0)


CONSTANT = Form("constant", "1", lambda x, w: np.ones_like(x))
LINEAR = Form("proportional", "x", lambda x, w: x)
SQUARE = Form("square", "x^2", lambda x, w: np.square(x))
SIGNED_SQUARE = Form("square against motion", "|x| x", lambda x, w: np.abs(x) * x)
CUBE = Form("cubic", "x^3", lambda x, w: x**3)
SIGN = Form("Coulomb", "sign(x)", lambda x, w: np.tanh(x / (SHARP * w)))
JUMP = Form("step at zero", SIGN.formula, SIGN.at)
MODULUS = Form("modulus", "|x|", lambda x, w: np.abs(x))
SINE = Form("sine", "sin(x)", lambda x, w: np.sin(x))
COSINE = Form("cosine", "cos(x)", lambda x, w: np.cos(x))
RAMP = Form("ramp above", "max(x - p, 0)", lambda x, w, p: _up(x - p), _steps(14), (0.3,))
DOWN = Form("ramp below", "max(p - x, 0)", lambda x, w, p: _up(p - x), _steps(14), (0.3,))
BEND = Form("bend above", "max(x - p, 0)^2", lambda x, w, p: _up(x - p) ** 2, _steps(7), (0.3,))
STEP = Form("step", "step(x - p)", lambda x, w, p: np.clip((x - p) / (SHARP * w) + 0.5, 0.0, 1.0),
            _steps(79), (0.3,))  # fmt: skip
STRIBECK = Form(
    "Stribeck",
    "sign(x) exp(-|x|/p)",
    lambda x, w, p: np.tanh(x / (SHARP * w)) * np.exp(-np.abs(x) / np.maximum(p, 1e-6)),
    ((0.02,), (0.05,), (0.1,), (0.2,)),
    (0.2,),
    relative=False,
)
SATURATING = Form(
    "saturating",
    "tanh(x/p)",
    lambda x, w, p: np.tanh(x / np.maximum(p, 1e-6)),
    ((0.01,), (0.03,), (0.1,), (0.2,)),
    (0.2,),
    relative=False,
)
WIDTHS = ((0.02,), (0.05,), (0.1,), (0.2,), (0.3,), (0.4,))
"""Of a dead zone, to either side of zero, as shares of the range."""

DEAD_ZONE = Form(
    "dead zone",
    "sign(x) max(|x| - p, 0)",
    lambda x, w, p: np.sign(x) * _up(np.abs(x) - np.abs(p)),
    WIDTHS,
    (0.2,),
    relative=False,
)
LIMITED = Form(
    "limited",
    "sign(x) min(|x|, p)",
    lambda x, w, p: np.clip(x, -np.abs(p), np.abs(p)),
    WIDTHS,
    (0.2,),
    relative=False,
)
DECAY = Form(
    "decaying",
    "exp(-x/p)",
    lambda x, w, p: np.exp(-x / np.maximum(p, 1e-6)),
    ((0.05,), (0.1,), (0.25,), (0.5,)),
    (0.3,),
    relative=False,
)
TONE = Form(
    "tone",
    "sin(p x + q)",
    lambda x, w, p, q: np.sin(p * x + q),
    relative=False,
)
"""Its frequency and phase come from a scan, not from the table of starts."""

FORMS: dict[str, tuple[Form, ...]] = {
    "position": (
        *(CONSTANT, LINEAR, SQUARE, CUBE, SINE, COSINE, MODULUS, JUMP, RAMP, DOWN, BEND),
        DEAD_ZONE,
    ),
    "speed": (LINEAR, SIGNED_SQUARE, CUBE, SIGN, SQUARE, MODULUS, STRIBECK, SATURATING),
    "time": (CONSTANT, LINEAR, SQUARE, CUBE, RAMP, BEND, STEP, DECAY),
    "command": (
        CONSTANT,
        LINEAR,
        SQUARE,
        SIGNED_SQUARE,
        CUBE,
        JUMP,
        MODULUS,
        RAMP,
        DOWN,
        DEAD_ZONE,
        LIMITED,
    ),
}
"""What is tried of each kind of variable. Source: the field's textbook laws of friction, springs,
drag, cogging, drift and saturation (Armstrong-Helouvry et al. 1994; Stribeck 1902)."""
