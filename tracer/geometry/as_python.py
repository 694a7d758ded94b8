"""Small kernels as plain Python: the same source, over numpy's numbers and arrays in the place of machine vectors.

What explains a single ray asks the very tests that trace it, without compiling anything for it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np

from tracer import simd
from tracer.geometry.memory import data_pointer


def _fma(a: Any, b: Any, c: Any) -> Any:
    """a * b + c, rounded once: in float64 the product of two float32 is exact."""
    return np.float32(np.float64(a) * np.float64(b) + np.float64(c))


def _number(kind: type) -> Callable[[Any], Any]:
    return lambda x: np.asarray(x).view(kind)[()]


_PLAIN: dict[int, Any] = {
    id(simd.as_f32): _number(np.float32),
    id(simd.as_i32): _number(np.int32),
    id(simd.maximum): np.maximum,
    id(simd.minimum): np.minimum,
    id(simd.select): np.where,
    id(simd.fma): _fma,
    id(simd.square_root): np.sqrt,
    id(data_pointer): np.ravel,
}


@cache
def as_python(kernel: Any) -> Any:
    """A kernel of arithmetic as a function of Python; raises AttributeError for what is no kernel."""
    plain = kernel.py_func
    scope = dict(plain.__globals__)
    for name in plain.__code__.co_names:
        used = scope.get(name)
        if id(used) in _PLAIN:
            scope[name] = _PLAIN[id(used)]
        elif hasattr(used, "py_func"):
            scope[name] = as_python(used)
    return FunctionType(plain.__code__, scope, plain.__name__, plain.__defaults__)
