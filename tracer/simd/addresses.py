"""Memory as integers: int64 addresses, and loads and stores at them.

An address is added to like any number, in bytes; whoever uses one keeps alive what it points into.
Vectors need no alignment.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types

from tracer.simd.vectors import F32x8, F32x16, F64x8, I32x8, I32x16, Mask, Vector, operation


@operation
def address_of(typingctx, array):
    """Address of the first element of a contiguous array."""
    if not isinstance(array, types.Array) or array.layout != "C":
        return None

    def codegen(context, builder, sig, args):
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.ptrtoint(data, ir.IntType(64))

    return types.int64(array), codegen


@operation
def local_memory(typingctx, size):
    """Address of so many bytes (a literal number) that last until the calling kernel returns, aligned to 64."""
    if not isinstance(size, types.IntegerLiteral):
        return None

    def codegen(context, builder, sig, args):
        kind = ir.ArrayType(ir.IntType(8), sig.args[0].literal_value)
        with builder.goto_entry_block():
            memory = builder.alloca(kind)
            memory.align = 64
        return builder.ptrtoint(memory, ir.IntType(64))

    return types.int64(size), codegen


def _pointer(context: Any, builder: Any, address: Any, kind: types.Type) -> Any:
    return builder.inttoptr(address, context.get_data_type(kind).as_pointer())


def _loading(kind: types.Type) -> Any:
    @operation
    def load(typingctx, address):
        """What lies at an address."""

        def codegen(context, builder, sig, args):
            value = builder.load(_pointer(context, builder, args[0], kind))
            value.align = 4 if isinstance(kind, Vector) else kind.bitwidth // 8  # type: ignore[attr-defined]
            return value

        return kind(types.int64), codegen

    return load


load_f32x8, load_f32x16, load_f64x8, load_i32x8, load_i32x16, load_f32, load_f64, load_i32, load_i64 = (
    _loading(kind)
    for kind in (F32x8, F32x16, F64x8, I32x8, I32x16, types.float32, types.float64, types.int32, types.int64)
)


@operation
def prefetch(typingctx, address):
    """Ask for the cache line of an address, which will be read soon: of no effect but on time."""

    def codegen(context, builder, sig, args):
        kind, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        name = "llvm.prefetch.p0"
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.VoidType(), [kind, number, number, number]), name
        )
        builder.call(function, [builder.inttoptr(args[0], kind), *(ir.Constant(number, k) for k in (0, 3, 1))])
        return context.get_dummy_value()

    return types.void(types.int64), codegen


@operation
def store(typingctx, address, value):
    """Write a vector, a float32, an int32 or an int64 to an address."""
    if not isinstance(value, (Vector, types.Float, types.Integer)):
        return None
    kind = types.float32 if isinstance(value, types.Float) else types.unliteral(value)

    def codegen(context, builder, sig, args):
        written = builder.store(args[1], _pointer(context, builder, args[0], kind))
        written.align = 4 if isinstance(kind, Vector) else kind.bitwidth // 8  # type: ignore[attr-defined]
        return context.get_dummy_value()

    return types.void(types.int64, kind), codegen


@operation
def store_where(typingctx, address, value, mask):
    """Write those lanes of a vector whose mask is true; the others' memory is not touched."""
    if not isinstance(value, Vector) or not isinstance(mask, Mask):
        return None

    def codegen(context, builder, sig, args):
        vector = args[1].type
        pointer = _pointer(context, builder, args[0], value)
        suffix = f"v{value.lanes}{'f32' if value.floating else 'i32'}"
        kind = ir.FunctionType(ir.VoidType(), [vector, pointer.type, ir.IntType(32), args[2].type])
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.masked.store.{suffix}.p0")
        builder.call(function, [args[1], pointer, ir.Constant(ir.IntType(32), 4), args[2]])
        return context.get_dummy_value()

    return types.void(types.int64, value, mask), codegen


@operation
def store_bytes(typingctx, address, value):
    """Write the lowest eight bits of every int32 of a vector as bytes, or a mask as so many bools."""
    if not isinstance(value, Mask) and not (isinstance(value, Vector) and not value.floating):
        return None

    def codegen(context, builder, sig, args):
        kind = ir.VectorType(ir.IntType(8), value.lanes)
        resized = (builder.zext if isinstance(value, Mask) else builder.trunc)(args[1], kind)
        written = builder.store(resized, builder.inttoptr(args[0], kind.as_pointer()))
        written.align = 1
        return context.get_dummy_value()

    return types.void(types.int64, value), codegen


@operation
def mark(typingctx, address):
    """Write a byte 1 to an address, where other threads may write the same at the same time."""

    def codegen(context, builder, sig, args):
        pointer = builder.inttoptr(args[0], ir.IntType(8).as_pointer())
        builder.store_atomic(ir.Constant(ir.IntType(8), 1), pointer, "monotonic", 1)
        return context.get_dummy_value()

    return types.void(types.int64), codegen


@operation
def call_native(typingctx, callback, a, b, c, d, e):
    """Call machine code (see `tracer.runtime.kernels.NativeCallback`) at an address, with five int64."""

    def codegen(context, builder, sig, args):
        kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64)] * 5)
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 6), codegen


def _pointing(kind: types.Type) -> Any:
    @operation
    def pointer_at(typingctx, address):
        """An address as numba's pointer, read and written like a flat array."""

        def codegen(context, builder, sig, args):
            return builder.inttoptr(args[0], context.get_value_type(sig.return_type))

        return types.CPointer(kind)(types.int64), codegen

    return pointer_at


f32_at, f64_at, i32_at, i64_at, u8_at = (
    _pointing(kind) for kind in (types.float32, types.float64, types.int32, types.int64, types.uint8)
)
