"""engine: MuJoCo's C functions called from compiled code through their addresses."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from ves_twin.core.compiled import compiled

# The address is an argument, not a global: a function with a ctypes global is never cached.


@intrinsic  # type: ignore[untyped-decorator]
def _call(typing_context: Any, address: Any, model: Any, data: Any) -> Any:
    signature = types.void(types.int64, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        function = ir.FunctionType(ir.VoidType(), [pointer, pointer]).as_pointer()
        target = builder.inttoptr(arguments[0], function)
        handles = [builder.inttoptr(argument, pointer) for argument in arguments[1:]]
        builder.call(target, handles)
        return context.get_dummy_value()

    return signature, generate


NO_CALL = 0
"""Address of no function."""


@compiled
def call_engine(address: int, model: int, data: int) -> None:
    """Call a MuJoCo function f(mjModel*, mjData*) by its address."""
    _call(address, model, data)


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in sorted(folder.glob(pattern)):
            return ctypes.CDLL(str(path))
    raise OSError(f"no MuJoCo library beside {folder}")


def handles(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[int, int]:
    """Addresses of the C structures, for calls from compiled code; valid while the objects live."""
    return int(model._address), int(data._address)  # noqa: SLF001  (no public name for it)


def address_of(function: str) -> int:
    """Address of a C function of the MuJoCo library, for instance "mj_step"."""
    return int(ctypes.cast(getattr(_library(), function), ctypes.c_void_p).value or 0)
