"""ColumnExpression: a simple formula of a log's columns, as `35.1 * u_volt` or `f1 - f2`."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray

_QUOTED = re.compile(r"`([^`]+)`")

_BINARY: Mapping[type[ast.operator], Callable[[FloatArray, FloatArray], FloatArray]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
}

ALLOWED = "columns, numbers, + - * / and parentheses; a name with blanks stands in backquotes"


@dataclass(frozen=True)
class ColumnExpression:
    """A formula of columns.

    Attributes:
        text: columns, numbers, + - * / and parentheses; `x [mm]` in backquotes is one column.
    """

    text: str

    @cached_property
    def _parsed(self) -> tuple[ast.expr, dict[str, str]]:
        """The formula, and the columns behind the words that stand for quoted ones."""
        quoted: dict[str, str] = {}

        def word(match: re.Match[str]) -> str:
            quoted[name := f"_quoted_{len(quoted)}"] = match[1]
            return name

        try:
            body = ast.parse(_QUOTED.sub(word, self.text.strip()), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise self._wrong(self.text) from None
        return body, quoted

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns that it needs.

        Raises:
            InvalidInputError: anything but a simple formula.
        """
        body, quoted = self._parsed
        self._check(body)
        names = [node.id for node in ast.walk(body) if isinstance(node, ast.Name)]
        return tuple(dict.fromkeys(quoted.get(name, name) for name in names))

    def value(self, columns: Mapping[str, FloatArray]) -> FloatArray:
        """Its value (n,) in every row; not a number where it divides by zero."""
        body, quoted = self._parsed
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return self._value(body, columns, quoted)

    def _check(self, node: ast.expr) -> None:
        if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            self._check(node.left)
            self._check(node.right)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            self._check(node.operand)
        elif not isinstance(node, ast.Name) and not _is_number(node):
            raise self._wrong(self.text)

    def _value(
        self, node: ast.expr, columns: Mapping[str, FloatArray], quoted: Mapping[str, str]
    ) -> FloatArray:
        if isinstance(node, ast.BinOp):
            left, right = (self._value(n, columns, quoted) for n in (node.left, node.right))
            return np.asarray(_BINARY[type(node.op)](left, right))
        if isinstance(node, ast.UnaryOp):
            inner = self._value(node.operand, columns, quoted)
            return -inner if isinstance(node.op, ast.USub) else inner
        if isinstance(node, ast.Name):
            return columns[quoted.get(node.id, node.id)]
        return np.asarray(ast.literal_eval(node), float)

    def _wrong(self, came: str) -> InvalidInputError:
        return InvalidInputError("formula of columns", came, ALLOWED)


def quoted(column: str) -> str:
    """A column as it stands in a formula."""
    return column if column.isidentifier() else f"`{column}`"


def _is_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)
