"""Vector types and what can be computed with them."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, register_model

operation: Any = intrinsic  # untyped: called without the typing context


class Vector(types.Type):
    """So many lanes of float32, float64 or int32."""

    def __init__(self, element: types.Number, lanes: int) -> None:
        self.element, self.lanes = element, lanes
        super().__init__(f"{element}x{lanes}")

    @property
    def mask(self) -> Mask:
        return Mask(self.lanes)

    @property
    def floating(self) -> bool:
        return isinstance(self.element, types.Float)

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Conversion | None:
        """A scalar stands for a vector of equal lanes."""
        if isinstance(other, types.Integer) or (isinstance(other, types.Float) and self.floating):
            return Conversion.unsafe
        return None


class Mask(types.Type):
    """So many truths."""

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(f"mask{lanes}")


F32x8, F32x16 = Vector(types.float32, 8), Vector(types.float32, 16)
I32x8, I32x16 = Vector(types.int32, 8), Vector(types.int32, 16)
F64x8 = Vector(types.float64, 8)
_ELEMENTS = {types.float32: ir.FloatType(), types.float64: ir.DoubleType(), types.int32: ir.IntType(32)}


@register_model(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Vector) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(_ELEMENTS[fe_type.element], fe_type.lanes))


@register_model(Mask)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Mask) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(ir.IntType(1), fe_type.lanes))


def splat(builder: Any, value: Any, lanes: int) -> Any:
    """LLVM's idiom for a vector of equal lanes."""
    kind = ir.VectorType(value.type, lanes)
    single = builder.insert_element(ir.Constant(kind, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes)
    return builder.shuffle_vector(single, ir.Constant(kind, ir.Undefined), zeros)


@lower_cast(types.Number, Vector)
def _from_scalar(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    return splat(builder, context.cast(builder, value, fromty, toty.element), toty.lanes)


def _common(args: tuple[Any, ...]) -> Vector | None:
    """The one vector type among arguments of which others may be scalars."""
    found = {a for a in args if isinstance(a, Vector)}
    scalars = all(isinstance(a, (Vector, types.Number)) for a in args)
    return found.pop() if len(found) == 1 and scalars else None


def _define(function: Callable, result: Callable[[Vector], types.Type | None], emit: Callable, count: int = 2) -> None:
    """Let an operator of Python work on vectors, or on vectors and scalars."""

    @infer_global(function)
    class _Template(AbstractTemplate):
        def generic(self, args: tuple[Any, ...], kws: Any) -> Any:
            kind = _common(args)
            if kind is None or result(kind) is None or len(args) != count or kws:
                return None
            return signature(result(kind), *[kind] * count)

    @lower_builtin(function, *[Vector] * count)
    def _lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return emit(builder, sig.args[0], *args)


def _arithmetic(floating: str, integer: str) -> Callable:
    return lambda builder, kind, *args: getattr(builder, floating if kind.floating else integer)(*args)


def _comparison(operation: str) -> Callable:
    def emit(builder: Any, kind: Vector, a: Any, b: Any) -> Any:
        return builder.fcmp_ordered(operation, a, b) if kind.floating else builder.icmp_signed(operation, a, b)

    return emit


for _operator, _floating, _integer in (
    (operator.add, "fadd", "add"),
    (operator.sub, "fsub", "sub"),
    (operator.mul, "fmul", "mul"),
):
    _define(_operator, lambda kind: kind, _arithmetic(_floating, _integer))
_define(operator.truediv, lambda kind: kind, lambda builder, kind, a, b: builder.fdiv(a, b))
_define(operator.neg, lambda kind: kind, _arithmetic("fneg", "neg"), 1)
for _operator, _symbol in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
):
    _define(_operator, lambda kind: kind.mask, _comparison(_symbol))


def _shift(name: str) -> Callable:
    return lambda builder, kind, a, b: getattr(builder, name)(a, b)


_define(operator.lshift, lambda kind: None if kind.floating else kind, _shift("shl"))
_define(operator.rshift, lambda kind: None if kind.floating else kind, _shift("ashr"))
for _operator, _name in ((operator.and_, "and_"), (operator.or_, "or_"), (operator.xor, "xor")):
    _define(
        _operator, lambda kind: None if kind.floating else kind, lambda b, kind, x, y, _n=_name: getattr(b, _n)(x, y)
    )


def _define_on_masks(function: Callable, emit: Callable, count: int) -> None:
    @infer_global(function)
    class _Template(AbstractTemplate):
        def generic(self, args: tuple[Any, ...], kws: Any) -> Any:
            if len(args) == count and not kws and isinstance(args[0], Mask) and len(set(args)) == 1:
                return signature(args[0], *args)
            return None

    @lower_builtin(function, *[Mask] * count)
    def _lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return emit(builder, *args)


_define_on_masks(operator.and_, lambda builder, a, b: builder.and_(a, b), 2)
_define_on_masks(operator.or_, lambda builder, a, b: builder.or_(a, b), 2)
_define_on_masks(operator.invert, lambda builder, a: builder.not_(a), 1)


def _splatting(kind: Vector) -> Any:
    @operation
    def make(typingctx: Any, value: Any) -> Any:
        """A vector whose lanes all hold this number."""
        return kind(kind), lambda context, builder, sig, args: args[0]

    return make


f32x8, f32x16, i32x8, i32x16 = (_splatting(kind) for kind in (F32x8, F32x16, I32x8, I32x16))


def _masking(lanes: int) -> Any:
    @operation
    def make(typingctx: Any, bits: Any) -> Any:
        """The mask of an integer's lowest bits, lane 0 the lowest."""

        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.bitcast(builder.trunc(args[0], ir.IntType(lanes)), ir.VectorType(ir.IntType(1), lanes))

        return Mask(lanes)(types.int64), codegen

    return make


mask8, mask16 = _masking(8), _masking(16)


@operation
def lane_numbers_x16(typingctx):
    """0, 1, ... 15 as int32."""
    kind = ir.VectorType(ir.IntType(32), 16)
    return I32x16(), lambda context, builder, sig, args: ir.Constant(kind, list(range(16)))


@operation
def bits_of(typingctx, mask):
    """A mask as an int64, lane 0 the lowest bit."""

    def codegen(context, builder, sig, args):
        return builder.zext(builder.bitcast(args[0], ir.IntType(mask.lanes)), ir.IntType(64))

    return (types.int64(mask), codegen) if isinstance(mask, Mask) else None


@operation
def any_lane(typingctx, mask):
    """Whether any lane is true."""

    def codegen(context, builder, sig, args):
        bits = builder.bitcast(args[0], ir.IntType(mask.lanes))
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return (types.boolean(mask), codegen) if isinstance(mask, Mask) else None


@operation
def all_lanes(typingctx, mask):
    """Whether every lane is true."""

    def codegen(context, builder, sig, args):
        bits = builder.bitcast(args[0], ir.IntType(mask.lanes))
        return builder.icmp_unsigned("==", bits, ir.Constant(bits.type, -1))

    return (types.boolean(mask), codegen) if isinstance(mask, Mask) else None


@operation
def select(typingctx, mask, a, b):
    """a in the lanes where the mask is true, else b."""
    if not isinstance(mask, Mask):
        return None
    kind = _common((a, b))
    if kind is None and isinstance(a, types.Number) and isinstance(b, types.Number):
        floating = isinstance(a, types.Float) or isinstance(b, types.Float)
        kind = Vector(types.float32 if floating else types.int32, mask.lanes)
    if kind is None or kind.lanes != mask.lanes:
        return None
    return kind(mask, kind, kind), lambda context, builder, sig, args: builder.select(*args)


def _choosing(symbol: str, what: str) -> Any:
    @operation
    def choose(typingctx, a, b):
        kind = _common((a, b)) or (types.float32 if isinstance(a, types.Float) and isinstance(b, types.Float) else None)
        if kind is None:
            return None
        floating = not isinstance(kind, Vector) or kind.floating

        def codegen(context, builder, sig, args):
            compare = builder.fcmp_ordered if floating else builder.icmp_signed
            return builder.select(compare(symbol, *args), *args)

        return kind(kind, kind), codegen

    choose.__doc__ = f"The {what} of two, lane by lane (or of two float32): b wherever either is NaN, as x86 has it."
    return choose


minimum, maximum = _choosing("<", "smaller"), _choosing(">", "larger")


@operation
def fma(typingctx, a, b, c):
    """a * b + c of vectors or float32: rounded once where the processor can, else twice, never by a library call."""
    kind = _common((a, b, c)) or (types.float32 if all(isinstance(x, types.Float) for x in (a, b, c)) else None)
    if kind is None:
        return None

    def codegen(context, builder, sig, args):
        return builder.call(_declared(builder, "llvm.fmuladd", args[0].type, 3), args)

    return kind(kind, kind, kind), codegen


def _declared(builder: Any, name: str, kind: Any, count: int) -> Any:
    """LLVM's intrinsic of that name over a type, declared in the module."""
    suffix = f"v{kind.count}f32" if isinstance(kind, ir.VectorType) else "f32"
    return cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind] * count), f"{name}.{suffix}")


@operation
def square_root(typingctx, a):
    """Square root of a vector of float32, or of one."""
    kind = a if isinstance(a, Vector) else types.float32

    def codegen(context, builder, sig, args):
        return builder.call(_declared(builder, "llvm.sqrt", args[0].type, 1), args)

    return kind(kind), codegen


def _reducing(symbol: str, what: str) -> Any:
    @operation
    def reduce(typingctx, a):
        if not isinstance(a, Vector):
            return None

        def codegen(context, builder, sig, args):
            value, lanes = args[0], a.lanes
            compare = builder.fcmp_ordered if a.floating else builder.icmp_signed
            while lanes > 1:  # halves against each other
                lanes //= 2
                halves = [
                    builder.shuffle_vector(
                        value, value, ir.Constant(ir.VectorType(ir.IntType(32), lanes), list(range(k, k + lanes)))
                    )
                    for k in (0, lanes)
                ]
                value = builder.select(compare(symbol, *halves), *halves)
            return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))

        return a.element(a), codegen

    reduce.__doc__ = f"The {what} of all lanes."
    return reduce


smallest, largest = _reducing("<", "smallest"), _reducing(">", "largest")


@operation
def lane_of(typingctx, a, lane):
    """One lane of a vector."""
    if not isinstance(a, Vector):
        return None
    return a.element(a, types.int64), lambda context, builder, sig, args: builder.extract_element(*args)


@operation
def to_f32(typingctx, a):
    """A vector of int32 as float32, rounded to the nearest."""
    kind = Vector(types.float32, a.lanes)
    return kind(a), lambda context, builder, sig, args: builder.sitofp(args[0], context.get_data_type(kind))


@operation
def to_i32(typingctx, a):
    """A vector of float32 as int32, rounded towards zero; no meaning where it does not fit."""
    kind = Vector(types.int32, a.lanes)
    return kind(a), lambda context, builder, sig, args: builder.fptosi(args[0], context.get_data_type(kind))
