"""Lanes that change places: packing, gathering, and rows of memory that become columns.

A table's row is read as a whole, from one cache line where rows are aligned; sixteen of them are
turned in registers, which costs a few cycles a row, where gathering each number by itself costs
more than that for every column.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types

from tracer.simd.vectors import F32x16, I32x16, Mask, Vector, operation

LANES = 16
_I1, _I32, _I64 = ir.IntType(1), ir.IntType(32), ir.IntType(64)


def _suffix(vector: ir.VectorType) -> str:
    return f"v{vector.count}{'f32' if isinstance(vector.element, ir.FloatType) else 'i32'}"


@operation
def pack(typingctx, value, mask):
    """A vector whose first lanes are those where the mask is true, in their order; the others have no meaning."""
    if not isinstance(value, Vector) or not isinstance(mask, Mask) or mask.lanes != value.lanes:
        return None

    def codegen(context, builder, sig, args):
        vector = args[0].type
        kind = ir.FunctionType(vector, [vector, args[1].type, vector])
        name = f"llvm.experimental.vector.compress.{_suffix(vector)}"
        function = cgutils.get_or_insert_function(builder.module, kind, name)
        return builder.call(function, [*args, ir.Constant(vector, ir.Undefined)])

    return value(value, mask), codegen


@operation
def load_spread_bytes16(typingctx, address, mask):
    """int32 that are 0 where a mask is false, and where it is true are bytes from memory, one after the other."""
    if mask != Mask(LANES):
        return None

    def codegen(context, builder, sig, args):
        loaded = ir.VectorType(ir.IntType(8), LANES)
        pointer = builder.inttoptr(args[0], ir.IntType(8).as_pointer())
        kind = ir.FunctionType(loaded, [pointer.type, args[1].type, loaded])
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.masked.expandload.v{LANES}i8")
        value = builder.call(function, [pointer, args[1], ir.Constant(loaded, [0] * LANES)])
        return builder.zext(value, context.get_data_type(I32x16))

    return I32x16(types.int64, mask), codegen


def _gathering(vector: Vector) -> Any:
    @operation
    def gather(typingctx, address, numbers):
        """The numbers of an array at `address` at sixteen places; each must be one of the array."""
        if numbers != I32x16:
            return None

        def codegen(context, builder, sig, args):
            result = context.get_data_type(vector)
            base = builder.inttoptr(args[0], result.element.as_pointer())
            places = builder.gep(base, [args[1]], source_etype=result.element)
            places.type = ir.VectorType(places.type, LANES)  # which llvmlite does not see
            everywhere = ir.Constant(ir.VectorType(_I1, LANES), [1] * LANES)
            kind = ir.FunctionType(result, [places.type, _I32, everywhere.type, result])
            name = f"llvm.masked.gather.{_suffix(result)}.v{LANES}p0"
            function = cgutils.get_or_insert_function(builder.module, kind, name)
            arguments = [places, ir.Constant(_I32, 4), everywhere, ir.Constant(result, ir.Undefined)]
            return builder.call(function, arguments)

        return vector(types.int64, numbers), codegen

    return gather


gather_f32x16, gather_i32x16 = _gathering(F32x16), _gathering(I32x16)


def _interleaved(builder: Any, a: Any, b: Any) -> tuple[Any, Any]:
    """Lanes of a and b by turns: those of the lower halves, and those of the upper."""
    half = LANES // 2
    orders = ([k + i // 2 + LANES * (i % 2) for i in range(LANES)] for k in (0, half))
    lower, upper = (ir.Constant(ir.VectorType(_I32, LANES), order) for order in orders)
    return builder.shuffle_vector(a, b, lower), builder.shuffle_vector(a, b, upper)


@operation
def load_columns(typingctx, address, numbers, columns):
    """Sixteen rows of a table of 8 or 16 float32, one for each lane, as its columns.

    The table begins at `address`, has `columns` (a literal number), and `numbers` is the address of the
    rows' numbers, sixteen int32.
    """
    if not isinstance(columns, types.IntegerLiteral) or columns.literal_value not in (8, 16):
        return None
    count = columns.literal_value

    def codegen(context, builder, sig, args):
        row = ir.VectorType(ir.FloatType(), count)
        numbers = builder.inttoptr(args[1], _I32.as_pointer())
        rows = []
        for lane in range(LANES):
            number = builder.load(builder.gep(numbers, [ir.Constant(_I32, lane)]))
            number.align = 4
            start = builder.mul(builder.sext(number, _I64), ir.Constant(_I64, 4 * count))
            loaded = builder.load(builder.inttoptr(builder.add(args[0], start), row.as_pointer()))
            loaded.align = 4
            rows.append(loaded)
        if count < LANES:  # two rows to a vector
            whole = ir.Constant(ir.VectorType(_I32, LANES), list(range(LANES)))
            rows = [builder.shuffle_vector(a, b, whole) for a, b in zip(rows[::2], rows[1::2], strict=True)]
        # A number's place is its vector's number and its lane in bits; each round turns these by one, as one
        # word: four of them bring the column to where the vector's number was, and the row to the lane.
        for _ in range(4):
            pairs = zip(rows[: count // 2], rows[count // 2 :], strict=True)
            rows = [made for a, b in pairs for made in _interleaved(builder, a, b)]
        return context.make_tuple(builder, sig.return_type, rows)

    return types.UniTuple(F32x16, count)(types.int64, types.int64, columns), codegen


# The two rows that are put in order, one pair after the other, to sort 8 or 16 with the fewest comparisons known (Knuth
# 1998, 5.3.4; Dobbelaere's list of sorting networks).
_SORTING = {
    8: "02 13 46 57 04 15 26 37 01 23 45 67 24 35 14 36 12 34 56",
    16: "0d 1c 2f 3e 48 56 7b 9a 05 17 29 34 6d 8e af bc 01 23 45 68 79 ab cd ef 02 13 4a 5b 67 89 ce df 12 3c 46 57 8a"
    " 9b de 14 26 58 7a 9d be 24 36 9c bd 35 68 79 ac 34 56 78 9a bc 67 89",
}


@operation
def sort_columns(typingctx, address, rows):
    """Sort each column of a table at an address, 8 or 16 rows (a literal number) of sixteen int32, the least first."""
    if not isinstance(rows, types.IntegerLiteral) or rows.literal_value not in _SORTING:
        return None
    count = rows.literal_value

    def codegen(context, builder, sig, args):
        kind = context.get_data_type(I32x16)
        places = [
            builder.inttoptr(builder.add(args[0], ir.Constant(_I64, 64 * k)), kind.as_pointer()) for k in range(count)
        ]
        x = []
        for place in places:
            x.append(builder.load(place))
            x[-1].align = 4
        for pair in _SORTING[count].split():
            i, j = int(pair[0], 16), int(pair[1], 16)
            less = builder.icmp_signed("<", x[i], x[j])
            x[i], x[j] = builder.select(less, x[i], x[j]), builder.select(less, x[j], x[i])
        for place, value in zip(places, x, strict=True):
            builder.store(value, place).align = 4
        return context.get_dummy_value()

    return types.void(types.int64, rows), codegen
