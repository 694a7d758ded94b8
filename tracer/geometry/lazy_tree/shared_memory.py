"""Memory that threads share while they build: pieces of it by address, and words that are read and written at once.

numba's own allocator gives the pieces, which nobody counts: who allocates one must free it.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types

from tracer.simd.vectors import operation

WORD = ir.IntType(64)


def _at(builder: Any, address: Any) -> Any:
    return builder.inttoptr(address, WORD.as_pointer())


@operation
def allocate(typingctx, size):
    """Address of so many bytes, which last until they are freed."""

    def codegen(context, builder, signature, args):
        return builder.ptrtoint(context.nrt.allocate(builder, args[0]), WORD)

    return types.int64(types.int64), codegen


@operation
def free(typingctx, address):
    """Give back what `allocate` gave."""

    def codegen(context, builder, signature, args):
        context.nrt.free(builder, builder.inttoptr(args[0], ir.IntType(8).as_pointer()))
        return context.get_dummy_value()

    return types.void(types.int64), codegen


@operation
def read_shared(typingctx, address):
    """The int64 at an address; what its writer wrote before `publish` can be read from now on."""

    def codegen(context, builder, signature, args):
        return builder.load_atomic(_at(builder, args[0]), "acquire", 8)

    return types.int64(types.int64), codegen


@operation
def publish(typingctx, address, value):
    """Write an int64 to an address, after all that was written before."""

    def codegen(context, builder, signature, args):
        builder.store_atomic(args[1], _at(builder, args[0]), "release", 8)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), codegen


@operation
def exchange(typingctx, address, expected, value):
    """Write an int64 to an address if what is `expected` is there: whether it was."""

    def codegen(context, builder, signature, args):
        result = builder.cmpxchg(_at(builder, args[0]), args[1], args[2], "acq_rel", "acquire")
        return builder.extract_value(result, 1)

    return types.boolean(types.int64, types.int64, types.int64), codegen


@operation
def add_shared(typingctx, address, value):
    """Add to the int64 at an address, of which nobody's addition is lost."""

    def codegen(context, builder, signature, args):
        builder.atomic_rmw("add", _at(builder, args[0]), args[1], "monotonic")
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), codegen
