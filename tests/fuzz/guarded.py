"""numpy's memory between pages that nobody may touch: who reads or writes past an array's end, or before its beginning,
ends the process at once, also by an address.

Each array of some size has pages of its own, with a forbidden page on either side; it ends where the second begins, or
begins where the first ends.  Linux only.
"""

from __future__ import annotations

import ctypes
import mmap
import os
from collections.abc import Iterator
from contextlib import contextmanager

from numpy._core import _multiarray_umath  # type: ignore[attr-defined,import-not-found,unused-ignore]

PAGE = mmap.PAGESIZE
LEAST = 64  # bytes: smaller arrays stay with malloc, as no kernel gets any
ALIGNED = 8  # bytes, so that the end of an array is at most so far from the forbidden page
_SET_HANDLER = 304  # numpy's C API: PyDataMem_SetHandler

_libc = ctypes.CDLL(None, use_errno=True)
_libc.mmap.restype = ctypes.c_void_p
_libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
_libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
_libc.mprotect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]
_libc.malloc.restype = _libc.realloc.restype = ctypes.c_void_p
_libc.malloc.argtypes = [ctypes.c_size_t]
_libc.realloc.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
_libc.free.argtypes = [ctypes.c_void_p]
_FORBIDDEN, _ALLOWED, _PRIVATE = 0, 3, 0x22  # PROT_NONE; PROT_READ | PROT_WRITE; MAP_PRIVATE | MAP_ANONYMOUS

_FIXED = 0x10  # MAP_FIXED
KEPT = "SHADOWCULL_TESTS_KEEP_PAGES" in os.environ
"""Whether what is freed stays forbidden to the end of the process."""

_Malloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
_Calloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
_Realloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
_Free = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)


class _Handler(ctypes.Structure):
    """PyDataMem_Handler of numpy's C API."""

    _fields_ = (
        ("name", ctypes.c_char * 127),
        ("version", ctypes.c_uint8),
        ("context", ctypes.c_void_p),
        ("malloc", _Malloc),
        ("calloc", _Calloc),
        ("realloc", _Realloc),
        ("free", _Free),
    )


class GuardedMemory:
    """Gives out memory, and counts what it has given; `at_end` says on which side of an array nothing is left."""

    def __init__(self) -> None:
        self.at_end = True
        self.given = 0
        self._blocks: dict[int, tuple[int, int, int]] = {}  # an address: where its pages begin, their size, and its own
        functions = _Malloc(self._malloc), _Calloc(self._calloc), _Realloc(self._realloc), _Free(self._free)
        self._handler = _Handler(b"guarded", 1, None, *functions)

    def _malloc(self, context: int, size: int) -> int:
        if size < LEAST:
            return _libc.malloc(size)
        inside = -(-size // PAGE) * PAGE
        whole = inside + 2 * PAGE
        base = _libc.mmap(None, whole, _FORBIDDEN, _PRIVATE, -1, 0)
        if base in (None, ctypes.c_void_p(-1).value) or _libc.mprotect(base + PAGE, inside, _ALLOWED):
            return 0  # numpy raises MemoryError
        address = base + PAGE + (inside - -(-size // ALIGNED) * ALIGNED if self.at_end else 0)
        self._blocks[address] = base, whole, size
        self.given += 1
        return address

    def _calloc(self, context: int, count: int, size: int) -> int:
        address = self._malloc(context, max(count * size, LEAST))  # of which everything is 0
        return address

    def _realloc(self, context: int, address: int, size: int) -> int:
        if address and address not in self._blocks:
            return _libc.realloc(address, size)
        new = self._malloc(context, max(size, LEAST))
        if address and new:
            ctypes.memmove(new, address, min(size, self._blocks[address][2]))
            self._free(context, address, 0)
        return new

    def _free(self, context: int, address: int, size: int) -> None:
        block = self._blocks.pop(address, None)
        if block is not None and KEPT:  # nobody gets these pages again, and nothing is in them
            _libc.mmap(block[0], block[1], _FORBIDDEN, _PRIVATE | _FIXED, -1, 0)
        elif block is not None:
            _libc.munmap(block[0], block[1])
        elif address:
            _libc.free(address)

    @contextmanager
    def used(self, at_end: bool = True) -> Iterator[None]:
        """What numpy allocates meanwhile is guarded, for as long as it lives."""
        self.at_end = at_end
        before = _exchange(_capsule(self._handler))
        try:
            yield
        finally:
            _exchange(before)


MEMORY = GuardedMemory()
"""The one of this process: arrays may live until it ends."""


def _capsule(handler: _Handler) -> object:
    make = ctypes.pythonapi.PyCapsule_New
    make.restype, make.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return make(ctypes.addressof(handler), b"mem_handler", None)


def _exchange(handler: object) -> object:
    """Have numpy use another handler; returns the one before."""
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    table = ctypes.cast(pointer(_multiarray_umath._ARRAY_API, None), ctypes.POINTER(ctypes.c_void_p))
    return ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(table[_SET_HANDLER])(handler)
