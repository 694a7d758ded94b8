"""How this package compiles: one decorator for every kernel, and where the compiled code is kept.

numba keys its cache by the file a kernel stands in, and so misses a change in a helper that the
kernel calls.  The folder here is therefore named by a hash over *all* kernel sources: a changed
source never meets stale machine code.  It lies in `SHADOWCULL_CACHE_DIR`, else in .cache of a source
tree, else in the user's cache folder; where that cannot be written, a temporary folder serves for
the life of the process.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba import cfunc, njit
from numba.core import config as _config
from numba.core import types

_KERNEL_FOLDERS = ("simd", "geometry", "culling", "shading")


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent
    for path in [
        Path(__file__),
        root / "scene" / "model.py",
        *sorted(p for f in _KERNEL_FOLDERS for p in (root / f).rglob("*.py")),
    ]:
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """The folder of this version's compiled kernels; made, and known to be writable."""
    base, source_tree = os.environ.get("SHADOWCULL_CACHE_DIR"), Path(__file__).parents[1]
    if base:
        root = Path(base).expanduser()
    elif (source_tree / "pyproject.toml").exists():
        root = source_tree / ".cache" / "kernels"
    else:
        root = Path(platformdirs.user_cache_dir("shadowcull")) / "kernels"
    folder = root / _source_hash()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="shadowcull-kernels-"))


_njit: Any = njit
_cfunc: Any = cfunc
_OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}


def kernel(function: Callable) -> Any:
    """Compile a function that Python calls: cached, free of the GIL, division by zero as in IEEE 754."""
    config: Any = _config  # its names are made at run time
    saved, config.CACHE_DIR = config.CACHE_DIR, str(cache_folder())
    try:
        return _njit(cache=True, **_OPTIONS)(function)
    finally:
        config.CACHE_DIR = saved


def subkernel(function: Callable) -> Any:
    """Compile a function that only kernels call (from Python it crashes): cached with them, it needs no way in."""
    return _njit(no_cpython_wrapper=True, **_OPTIONS)(function)


def inlined(function: Callable) -> Any:
    """A small subkernel that disappears into its callers."""
    return _njit(no_cpython_wrapper=True, forceinline=True, **_OPTIONS)(function)


class Entry:
    """Machine code that kernels call by address and Python by `call`: compiled, or loaded, when first wanted.

    The function takes five int64 and returns nothing (`tracer.geometry.queries`).
    """

    def __init__(self, function: Callable) -> None:
        self._function = function
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self) -> Any:
        config: Any = _config
        saved, config.CACHE_DIR = config.CACHE_DIR, str(cache_folder())
        try:
            signature = types.void(*[types.int64] * 5)
            return _cfunc(signature, cache=True, error_model="numpy")(self._function)
        finally:
            config.CACHE_DIR = saved

    def compile(self) -> None:
        """Make it ready now."""
        _ = self._compiled

    @property
    def address(self) -> int:
        return self._compiled.address

    def call(self, data: int, batch: int, first: int, last: int, counts: int) -> None:
        """Call it from Python, without the GIL."""
        self._compiled.ctypes(data, batch, first, last, counts)


def entry(function: Callable) -> Entry:
    """Compile a structure's query (see `Entry`)."""
    return Entry(function)
