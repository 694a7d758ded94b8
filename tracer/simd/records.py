"""Records: declared once as a NamedTuple, laid out in memory and read in kernels by what the declaration says.

Two kinds of memory hold records.

- *Rows.*  Many points or rays as a structure of arrays: a (rows, n) float32 array in which each field has one row, or
  three for a vector.  `rows_of` gives the kernel that names the rows, `row_count` how many there are, and `row_number`
  where a field's rows begin.
- *Blocks.*  What a `NativeCallback` (`tracer.runtime.kernels`) is given: the addresses and shapes of arrays,
  and numbers, eight bytes each.  `pack` or the kernel of `writing` makes a block, and the kernel of `reading` reads it.

A kernel that names the fields is made from the declaration, so that neither can fall out of step with the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np
from numba import carray
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined
from tracer.simd.addresses import address_of, f32_at, f64_at, i32_at, i64_at, load_f64, load_i64, store, u8_at


class Rows(NamedTuple):
    """So many rows of a (rows, n) array, read as this type."""

    rows: int
    kind: str


Memory = Annotated[NDArray[np.float32], "memory"]  # the array itself, all rows
Row = Annotated[NDArray[np.float32], Rows(1, "float32")]  # (n,)
Row3 = Annotated[NDArray[np.float32], Rows(3, "float32")]  # (3, n)
IntRow = Annotated[NDArray[np.int32], Rows(1, "int32")]  # (n,)


@cache  # blocks are packed many times a frame, and evaluating hints takes longer than packing
def _fields(record: type) -> dict[str, Any]:
    hints = get_type_hints(record, include_extras=True)
    return {name: hints[name] for name in record._fields}  # type: ignore[attr-defined]


def _row_fields(record: type) -> dict[str, tuple[int, Rows]]:
    """The first row of each field that has rows, and what they are."""
    found, first = {}, 0
    for name, hint in _fields(record).items():
        marks = [mark for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, Rows)]
        if marks:
            found[name] = first, marks[0]
            first += marks[0].rows
    return found


def row_number(record: type, field: str) -> int:
    """The first row of a field."""
    return _row_fields(record)[field][0]


def row_count(record: type) -> int:
    """How many rows memory for a record has."""
    return sum(rows.rows for _, rows in _row_fields(record).values())


def rows_of(record: type) -> Any:
    """The kernel that names the rows of a memory: (memory, ...) -> record.

    Fields that have no rows, other than the memory itself, are its further arguments, in their order."""
    rows, hints = _row_fields(record), _fields(record)
    values, others = [], []
    for name, hint in hints.items():
        if name in rows:
            first, (count, kind) = rows[name]
            place = f"memory[{first}]" if count == 1 else f"memory[{first}:{first + count}]"
            values.append(place if kind == "float32" else f"{place}.view({kind})")
        elif "memory" in getattr(hint, "__metadata__", ()):
            values.append("memory")
        else:
            values.append(name)
            others.append(name)
    return _kernel(f"({', '.join(['memory', *others])}): return record({', '.join(values)})", record)


_POINTERS = {"float32": f32_at, "float64": f64_at, "int32": i32_at, "int64": i64_at, "uint8": u8_at}


@dataclass(frozen=True)  # no tuple, which is equal to `Rows` of the same numbers: `Annotated` takes either for both
class _Array:
    """An array of so many dimensions; of none for a flat pointer to its numbers, whose shape nobody is told."""

    dimensions: int
    kind: str


F32 = Annotated[NDArray[np.float32], _Array(1, "float32")]
F32x2D = Annotated[NDArray[np.float32], _Array(2, "float32")]
F32x3D = Annotated[NDArray[np.float32], _Array(3, "float32")]
I32 = Annotated[NDArray[np.int32], _Array(1, "int32")]
I32x2D = Annotated[NDArray[np.int32], _Array(2, "int32")]
I64 = Annotated[NDArray[np.int64], _Array(1, "int64")]
I64x2D = Annotated[NDArray[np.int64], _Array(2, "int64")]
Bytes = Annotated[NDArray[Any], _Array(1, "uint8")]  # uint8 or bool
F32At = Annotated[NDArray[np.float32], _Array(0, "float32")]
I32At = Annotated[NDArray[np.int32], _Array(0, "int32")]
I64At = Annotated[NDArray[np.int64], _Array(0, "int64")]
BytesAt = Annotated[NDArray[Any], _Array(0, "uint8")]


def pack(value: Any) -> NDArray[np.int64]:
    """A record as a block; whoever keeps the block keeps the arrays of the record as well.

    Raises TypeError for an array that is not what the declaration says."""
    numbers: list[int] = []
    for (name, hint), given in zip(_fields(value.__class__).items(), value):
        mark = _array_of(hint)
        if mark is not None:
            same = given.dtype == mark.kind or (mark.kind == "uint8" and given.dtype == np.bool_)
            fits = mark.dimensions in (0, given.ndim)
            if not fits or not same or not given.flags.c_contiguous:
                raise TypeError(f"{type(value).__name__}.{name} is not {mark}")
            numbers += [given.ctypes.data, *given.shape[: mark.dimensions]]
        elif hasattr(hint, "_fields"):
            numbers += pack(given).tolist()
        elif hint is float:
            numbers.append(int(np.float64(given).view(np.int64)))
        else:
            numbers.append(int(given))
    return np.array(numbers, np.int64)


def reading(record: type) -> Any:
    """The kernel that reads a block: (address) -> record."""
    value, _, names = _read(record, 0, "record")
    return _kernel(f"(address): return {value}", record, names)


def writing(record: type) -> Any:
    """The kernel that writes a block of a record of arrays and whole numbers: (address, record).

    Raises TypeError for a record with other fields."""
    code, at = "(address, given):\n", 0
    for field, hint in _fields(record).items():
        mark = _array_of(hint)
        if mark is None:
            if hint is not int and hint is not bool:
                raise TypeError(f"{record.__name__}.{field} is no array or whole number")
            code += f"  store(address + {8 * at}, int64(given.{field}))\n"
            at += 1
            continue
        code += f"  store(address + {8 * at}, address_of(given.{field}))\n"
        for k in range(mark.dimensions):
            code += f"  store(address + {8 * (at + 1 + k)}, int64(given.{field}.shape[{k}]))\n"
        at += 1 + mark.dimensions
    return _kernel(code, record)


def block_size(record: type) -> int:
    """Bytes of a block."""
    return 8 * _read(record, 0, "record")[1]


def offset_of(record: type, field: str) -> int:
    """Bytes from the beginning of a block of whole numbers to a field."""
    return 8 * list(_fields(record)).index(field)


def _array_of(hint: Any) -> _Array | None:
    marks = [mark for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, _Array)]
    return marks[0] if marks else None


def _read(record: type, at: int, name: str) -> tuple[str, int, dict[str, type]]:
    """The expression that reads a record from the number `at` on, where it ends, and the classes that it names."""
    values, names = [], {name: record}
    for field, hint in _fields(record).items():
        mark = _array_of(hint)
        if mark is not None:
            shape = "".join(f"load_i64(address + {8 * (at + 1 + k)}), " for k in range(mark.dimensions))
            pointer = f"{mark.kind}_at(load_i64(address + {8 * at}))"
            values.append(f"carray({pointer}, ({shape}))" if shape else pointer)
            at += 1 + mark.dimensions
        elif hasattr(hint, "_fields"):
            value, at, more = _read(hint, at, f"{name}_{field}")
            values.append(value)
            names |= more
        else:
            load = f"load_f64(address + {8 * at})" if hint is float else f"load_i64(address + {8 * at})"
            values.append(f"{load} != 0" if hint is bool else load)
            at += 1
    return f"{name}({', '.join(values)})", at, names


def _kernel(code: str, record: type, names: dict[str, type] | None = None) -> Any:
    """An inlined kernel of this code, made where nothing else is known but what it needs."""
    scope: dict[str, Any] = {
        "__name__": record.__module__,
        "record": record,
        "int32": np.int32,
        "int64": np.int64,
        "carray": carray,
        **(names or {}),
    }
    scope |= {"load_i64": load_i64, "load_f64": load_f64, "store": store, "address_of": address_of}
    scope |= {f"{kind}_at": at for kind, at in _POINTERS.items()}
    exec(f"def read{code}", scope)
    function: Callable = scope["read"]
    function.__doc__ = f"The fields of {record.__name__}, as they lie in memory."
    return inlined(function)
