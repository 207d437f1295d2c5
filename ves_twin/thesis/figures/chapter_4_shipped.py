"""shipped: a procedure as it is shipped, for a figure that draws its result."""

from __future__ import annotations

from typing import TypeVar

from ves_twin.core.errors import InvalidInputError
from ves_twin.procedures.procedure import Procedure
from ves_twin.procedures.registry import load_procedure

Kind = TypeVar("Kind", bound=Procedure)


def shipped(name: str, kind: type[Kind]) -> Kind:
    """The procedure of a name, if it is of the class asked for.

    Raises:
        InvalidInputError: it is of another class.
    """
    procedure = load_procedure(name)
    if not isinstance(procedure, kind):
        raise InvalidInputError(f"scenario {name}", type(procedure).__name__, kind.__name__)
    return procedure
