"""How this package compiles: one decorator for every kernel.  `tracer.runtime.kernel_cache` keeps what is compiled."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

from numba import njit, types
from numba.core.ccallback import CFunc

from tracer.runtime.kernel_cache import cache_of
from tracer.runtime.subkernels import SubkernelCompiler

_njit: Any = njit
_cfunc: Any = CFunc
_OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
_LINKED = _OPTIONS | {"no_cpython_wrapper": True, "pipeline_class": SubkernelCompiler}


def kernel(function: Callable) -> Any:
    """Compile a function that Python calls: cached, free of the GIL, division by zero as in IEEE 754."""
    dispatcher = _njit(**_OPTIONS)(function)
    dispatcher._cache = cache_of(function)
    return dispatcher


def subkernel(function: Callable) -> Any:
    """Compile a function that only kernels call (from Python it crashes): cached with them, and linked into them."""
    return _njit(**_LINKED)(function)


def inlined(function: Callable) -> Any:
    """A small subkernel that disappears into its callers."""
    return _njit(forceinline=True, **_LINKED)(function)


_SIGNATURE: Any = types.void(*[types.int64] * 5)


class NativeCallback:
    """Machine code that kernels call by address and Python by `call`: compiled, or loaded, when first wanted.

    The function takes five int64 and returns nothing (`tracer.geometry.queries`).
    """

    def __init__(self, function: Callable) -> None:
        self._function = function
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self) -> Any:
        compiled = _cfunc(self._function, (_SIGNATURE.args, _SIGNATURE.return_type), {}, {"error_model": "numpy"})
        compiled._cache = cache_of(self._function)
        compiled.compile()
        return compiled

    def compile(self) -> None:
        """Make it ready now."""
        _ = self._compiled

    @property
    def address(self) -> int:
        return self._compiled.address

    def call(self, data: int, batch: int, first: int, last: int, counts: int) -> None:
        """Call it from Python, without the GIL."""
        self._compiled.ctypes(data, batch, first, last, counts)


def native_callback(function: Callable) -> NativeCallback:
    """Compile a structure's query (see `NativeCallback`)."""
    return NativeCallback(function)
