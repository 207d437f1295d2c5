"""mutants: small wrong changes to a module, one at a time, each as text that still parses."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

COMPARED: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">="),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<="),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
"""Comparison -> its boundary moved, and its opposite."""

REPLACED: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.Pow: "*",
    ast.Mod: "*",
    ast.FloorDiv: "*",
    ast.MatMult: "*",
}

SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"} | {
    ast.Mod: "%", ast.FloorDiv: "//", ast.MatMult: "@",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        module: path of the file below the repository's root.
        function: where in it; empty at the top level.
        kind: comparison, arithmetic, constant, boolean or return.
        line: where it is.
        old: what stands there.
        new: what stands there instead.
        span: characters of the file that are replaced.
        key: of the change, whatever lines stand around its function.
        around: hash of the function or the statement of the module that it stands in.
        first: first line of that function, its decorators counted; 0 of a statement.
    """

    module: str
    function: str
    kind: str
    line: int
    old: str
    new: str
    span: tuple[int, int]
    key: str
    around: str
    first: int

    @property
    def identity(self) -> tuple[str, str]:
        """What an outcome is of."""
        return self.key, self.around

    def text(self, source: str) -> str:
        """The file with the change."""
        return source[: self.span[0]] + self.new + source[self.span[1] :]


def mutants_of(path: Path, module: str) -> list[Mutant]:
    """Every mutant of a file; texts, messages of errors, annotations and decorators are left."""
    source = path.read_text(encoding="utf-8")
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))
    content = source.encode()

    def place(node: ast.AST) -> tuple[int, int]:
        first = starts[node.lineno - 1] + node.col_offset
        last = starts[node.end_lineno - 1] + node.end_col_offset
        return len(content[:first].decode()), len(content[:last].decode())

    found: list[Mutant] = []
    seen: dict[str, int] = {}
    tree = ast.parse(source)
    holders = list(_holders(tree))
    for function, node in _nodes(tree, ""):
        for kind, new in _changes(node, lambda n: source[slice(*place(n))]):
            span = place(node)
            old = source[slice(*span)]
            if new == old:
                continue
            label = f"{path.stem} {function} {kind} {old} {new}"
            seen[label] = seen.get(label, 0) + 1
            key = hashlib.sha256(f"{label} {seen[label]}".encode()).hexdigest()[:16]
            holder = next(h for h in holders if h.lineno <= node.lineno <= h.end_lineno)
            around = hashlib.sha256(source[slice(*place(holder))].encode()).hexdigest()[:16]
            first = _first(holder)
            change = Mutant(module, function, kind, node.lineno, old, new, span, key, around, first)
            ast.parse(change.text(source))
            found.append(change)
    return found


def _holders(tree: ast.AST) -> Iterator[ast.stmt]:
    """Statements of a module and of its classes; a decorator belongs to no holder."""
    for statement in tree.body:
        if isinstance(statement, ast.ClassDef):
            yield from _holders(statement)
        else:
            yield statement


def _first(holder: ast.stmt) -> int:
    if not isinstance(holder, ast.FunctionDef):
        return 0
    return min(node.lineno for node in (holder, *holder.decorator_list))


def _nodes(node: ast.AST, function: str, result: str = "") -> Iterator[tuple[str, ast.AST]]:
    """Nodes that compute something, each with the function it stands in."""
    if isinstance(node, ast.FunctionDef):
        function = f"{function}.{node.name}".lstrip(".")
        result = ast.unparse(node.returns) if node.returns else ""
        inside: list[ast.AST] = [*node.args.defaults, *node.body]
    elif isinstance(node, ast.ClassDef):
        function, inside = f"{function}.{node.name}".lstrip("."), list(node.body)
    elif isinstance(node, ast.AnnAssign):
        inside = [node.value] if node.value else []
    elif isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return
    elif isinstance(node, ast.keyword) and node.arg == "strict":
        return  # of zip: it guards lengths that are equal
    else:
        inside = list(ast.iter_child_nodes(node))
    if isinstance(node, ast.Return):
        node.type_comment = result  # type: ignore[attr-defined]
    yield function, node
    for child in inside:
        yield from _nodes(child, function, result)


def _changes(node: ast.AST, text) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        left, right = text(node.left), text(node.comparators[0])
        for new in COMPARED[type(node.ops[0])]:
            yield "comparison", f"({left}) {new} ({right})"
    elif isinstance(node, ast.BinOp) and type(node.op) in REPLACED:
        new = REPLACED[type(node.op)]
        yield "arithmetic", f"(({text(node.left)}) {new} ({text(node.right)}))"
    elif isinstance(node, ast.AugAssign) and type(node.op) in REPLACED:
        new = REPLACED[type(node.op)]
        yield "arithmetic", f"{text(node.target)} {new}= {text(node.value)}"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        if not isinstance(node.operand, ast.Constant):
            yield "arithmetic", f"({text(node.operand)})"
    elif isinstance(node, ast.Constant):
        yield from _constants(node)
    else:
        yield from _logic(node, text)


def _constants(node: ast.Constant) -> Iterator[tuple[str, str]]:
    value = node.value
    if isinstance(value, bool):
        yield "constant", str(not value)
    elif isinstance(value, int):
        yield "constant", str(value + 1)
    elif isinstance(value, float):
        yield "constant", repr(2.0 * value if value else 1.0)


def _logic(node: ast.AST, text) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.BoolOp):
        word = "or" if isinstance(node.op, ast.And) else "and"
        yield "boolean", f"({f' {word} '.join(f'({text(v)})' for v in node.values)})"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.Invert):
        yield "boolean", f"({text(node.operand)})"
    elif isinstance(node, ast.IfExp):
        yield "boolean", f"({text(node.orelse)} if {text(node.test)} else {text(node.body)})"
    elif isinstance(node, ast.Continue):
        yield "return", "break"
    elif isinstance(node, ast.Return) and node.value is not None:
        value, kind = text(node.value), getattr(node, "type_comment", "")
        if kind == "bool":
            yield "return", f"return not ({value})"
        elif kind in {"float", "int", "FloatArray", "SingleArray"}:
            yield "return", f"return ({value}) + 1"
        else:
            yield "return", "return None"
