"""Integers as sets of bits, and numbers as their bits."""

from __future__ import annotations

from llvmlite import ir
from numba.core import types

from tracer.simd.vectors import F32x8, F32x16, I32x8, I32x16, operation

_AS_INTEGERS = {F32x8: I32x8, F32x16: I32x16, types.float32: types.int32}
_AS_FLOATS = {integer: floating for floating, integer in _AS_INTEGERS.items()}


@operation
def lowest_bit(typingctx, bits):
    """Number of the lowest set bit of an int64; 64 where none is set."""
    return types.int64(types.int64), lambda context, builder, sig, args: builder.cttz(
        args[0], ir.Constant(ir.IntType(1), 0)
    )


@operation
def leading_zeros(typingctx, bits):
    """How many unset bits lie above the highest set one of an int64."""
    return types.int64(types.int64), lambda context, builder, sig, args: builder.ctlz(
        args[0], ir.Constant(ir.IntType(1), 0)
    )


@operation
def ones(typingctx, bits):
    """How many bits of an int64 are set."""
    return types.int64(types.int64), lambda context, builder, sig, args: builder.ctpop(args[0])


@operation
def as_i32(typingctx, value):
    """The bits of float32 as int32, one or a vector of them."""
    if value not in _AS_INTEGERS:
        return None

    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], context.get_data_type(sig.return_type))

    return _AS_INTEGERS[value](value), codegen


@operation
def as_f32(typingctx, value):
    """int32 taken as the bits of float32, one (given by any integer) or a vector of them."""
    if isinstance(value, types.Integer):
        value = types.int32
    if value not in _AS_FLOATS:
        return None

    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], context.get_data_type(sig.return_type))

    return _AS_FLOATS[value](value), codegen
