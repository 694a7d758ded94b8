"""What is built when the first ray arrives, and the memory that threads share for it: one protocol for all trees.

Whatever may be missing has a word, an int64: negative while it is missing, UNBUILT or, where somebody builds it,
CLAIMED.  A ray that finds it so calls what builds it, which comes back once it is there, whoever has built it
(`built`).  Who builds writes all of it and then publishes the word (release); who reads the word (acquire) sees all of
that.

Memory comes from numba's own allocator, and nobody counts references: who allocates must free.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types

from tracer.runtime.kernels import inlined, kernel
from tracer.simd import address_of, call_native
from tracer.simd.vectors import operation

WORD = ir.IntType(64)
UNBUILT, CLAIMED = -2, -1


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


@inlined
def built(word, build, what, pause):
    """The word at an address, once what it stands for is there.

    `build` is the address of what builds it: a callback that is given `what`, and `pause`, the address of what lets
    other threads go on, or 0."""
    found = read_shared(word)
    while found < 0:
        call_native(build, what, pause, 0, 0, 0)
        found = read_shared(word)
    return found


@kernel
def publish_word(words, index, value):
    """As `publish`, for Python: the word of this number among words (n,) int64."""
    publish(address_of(words) + 8 * index, np.int64(value))
