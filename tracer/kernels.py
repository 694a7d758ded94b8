"""How this package compiles: one decorator for every kernel, and where the compiled code is kept.

numba keys its cache by the file a kernel stands in, and so misses a change in a helper that the
kernel calls.  The folder here is therefore named by a hash over *all* kernel sources: a changed
source never meets stale machine code.  It lies in `SHADOWCULL_CACHE_DIR`, else in .cache of a source
tree, else in the user's cache folder; where nothing can be written there, a temporary folder serves
for the life of the process.  Of the folders of other sources those used last are kept.

What goes wrong with the cache costs time and nothing else: what cannot be read is compiled, what
cannot be written is compiled again next time.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba import njit, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.ccallback import CFunc

from tracer.subkernels import SubkernelCompiler

_KERNEL_FOLDERS = ("simd", "geometry", "culling", "shading", "methods")
_ROOM = 1 << 25  # bytes; all kernels take a tenth of it
_KEPT = 16  # folders of as many sources, some 3 MB each


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent
    for path in [
        Path(__file__),
        root / "subkernels.py",
        root / "scene" / "model.py",
        root / "scene" / "lamps.py",
        *sorted(p for f in _KERNEL_FOLDERS for p in (root / f).rglob("*.py")),
    ]:
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_root() -> Path:
    base, source_tree = os.environ.get("SHADOWCULL_CACHE_DIR"), Path(__file__).parents[1]
    if base:
        return Path(base).expanduser()
    if (source_tree / "pyproject.toml").exists():
        return source_tree / ".cache" / "kernels"
    return Path(platformdirs.user_cache_dir("shadowcull")) / "kernels"


@cache
def cache_folder() -> Path:
    """The folder of this version's compiled kernels: it is there, and has kernels in it or room for them."""
    root = _cache_root()
    folder = root / _source_hash()
    try:
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            _remove_oldest(root)
        if not any(folder.iterdir()):
            if shutil.disk_usage(folder).free < _ROOM:
                raise OSError("no room")
            with tempfile.TemporaryFile(dir=folder):
                pass
    except OSError:
        folder = Path(_temporary_folder().name) / folder.name
        folder.mkdir(exist_ok=True)
    with suppress(OSError):
        os.utime(folder)  # used now
    return folder


def is_kept() -> bool:
    """Whether compiled kernels outlive this process: else no folder could be written to."""
    return cache_folder().parent == _cache_root()


@cache
def _temporary_folder() -> tempfile.TemporaryDirectory:
    """Removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="shadowcull-kernels-", ignore_cleanup_errors=True)


def _remove_oldest(root: Path) -> None:
    """Keep the folders that were used last; a process that still runs with another compiles what
    it has not loaded yet."""
    with suppress(OSError):
        folders = [folder for folder in root.iterdir() if re.fullmatch("[0-9a-f]{16}", folder.name)]
        folders.sort(key=lambda folder: folder.stat().st_mtime, reverse=True)
        for folder in folders[_KEPT:]:
            shutil.rmtree(folder, ignore_errors=True)


class _Locator(UserProvidedCacheLocator):
    """Where a function's compiled code is kept: in a folder of its source file's folder."""

    def __init__(self, function: Callable, source: str) -> None:
        super().__init__(function, source)
        self._cache_path = str(cache_folder() / self.get_suitable_cache_subpath(source))

    @classmethod
    def from_function(cls, function: Callable, source: str) -> _Locator:
        return cls(function, source)

    def ensure_cache_path(self) -> None:
        os.makedirs(self._cache_path, exist_ok=True)


class _CacheImpl(CompileResultCacheImpl):
    _locator_classes: Any = (_Locator,)


class _Cache(FunctionCache):
    """numba's cache of one function, that survives damage and a full disk, and may be written by many at once."""

    _impl_class = _CacheImpl

    def load_overload(self, signature: Any, context: Any) -> Any:
        try:
            return super().load_overload(signature, context)
        except Exception:  # a damaged file may raise anything while it is unpickled
            with suppress(OSError), self._alone():
                self.flush()
            return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        with suppress(OSError), self._alone():
            super().save_overload(signature, compiled)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Save one at a time: two processes that number two signatures at once may give both the same file."""
        from filelock import FileLock  # takes as long to import as all of this, and is needed only after compiling

        with FileLock(cache_folder() / "lock", poll_interval=0.01):
            yield


_njit: Any = njit
_cfunc: Any = CFunc
_OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
_LINKED = _OPTIONS | {"no_cpython_wrapper": True, "pipeline_class": SubkernelCompiler}


def kernel(function: Callable) -> Any:
    """Compile a function that Python calls: cached, free of the GIL, division by zero as in IEEE 754."""
    dispatcher = _njit(**_OPTIONS)(function)
    dispatcher._cache = _Cache(function)
    return dispatcher


def subkernel(function: Callable) -> Any:
    """Compile a function that only kernels call (from Python it crashes): cached with them, and linked into them."""
    return _njit(**_LINKED)(function)


def inlined(function: Callable) -> Any:
    """A small subkernel that disappears into its callers."""
    return _njit(forceinline=True, **_LINKED)(function)


_ENTRY: Any = types.void(*[types.int64] * 5)


class Entry:
    """Machine code that kernels call by address and Python by `call`: compiled, or loaded, when first wanted.

    The function takes five int64 and returns nothing (`tracer.geometry.queries`).
    """

    def __init__(self, function: Callable) -> None:
        self._function = function
        self.__doc__ = function.__doc__

    @cached_property
    def _compiled(self) -> Any:
        compiled = _cfunc(self._function, (_ENTRY.args, _ENTRY.return_type), {}, {"error_model": "numpy"})
        compiled._cache = _Cache(self._function)
        compiled.compile()
        return compiled

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
