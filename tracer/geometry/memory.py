"""Memory without reference counts, for kernels.

numba counts references to arrays, atomically, wherever one is passed on or taken out of a tuple.  In an inner loop that
costs more than a step through a tree, and threads fight over shared counts.  `without_refcount` gives the same arrays
uncounted, and `data_pointer` an array's bare memory.  Either is valid only as long as somebody else keeps the arrays
alive: a kernel may borrow what it was called with.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numpy.typing import NDArray

from tracer.simd.vectors import operation


def aligned_rows(rows: int, columns: int) -> NDArray[np.float32]:
    """Uninitialised (rows, columns) float32 whose memory begins at a multiple of 64 bytes, the size of a cache line."""
    memory = np.empty(4 * rows * columns + 64, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + 4 * rows * columns].view(np.float32).reshape(rows, columns)


@operation
def data_pointer(typingctx, array):
    """Pointer to the first element of a contiguous array, read and written like a flat array."""
    if not isinstance(array, types.Array) or array.layout != "C":
        return None

    def codegen(context, builder, signature, args):
        return context.make_array(signature.args[0])(context, builder, args[0]).data

    return types.CPointer(array.dtype)(array), codegen


def _without_counts(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: list[Any] = list(kind)  # type: ignore[call-overload]
        for i, member in enumerate(members):
            item = _without_counts(context, builder, member, builder.extract_value(value, i))
            value = builder.insert_value(value, item, i)
    return value


@operation
def without_refcount(typingctx, data):
    """The same array, or tuple of arrays, tuples and numbers, with no reference counted."""

    def codegen(context, builder, signature, args):
        return _without_counts(context, builder, signature.args[0], args[0])

    return data(data), codegen


@operation
def keep_alive(typingctx, data):
    """Let an array, or a tuple of arrays, live until here.

    numba frees an array after the last line that names it, even where others still have its address."""

    def codegen(context, builder, signature, args):
        return context.get_dummy_value()

    return types.void(data), codegen


def _local(dtype):
    @operation
    def local(typingctx, count):
        """Memory for `count` (a literal number) elements that lasts until the calling kernel returns."""
        if not isinstance(count, types.IntegerLiteral):
            return None

        def codegen(context, builder, signature, args):
            size = ir.Constant(ir.IntType(64), signature.args[0].literal_value)
            return cgutils.alloca_once(builder, context.get_data_type(dtype), size=size)

        return types.CPointer(dtype)(count), codegen

    return local


local_float32 = _local(types.float32)
local_int32 = _local(types.int32)
