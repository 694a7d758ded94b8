"""Where compiled kernels are kept: a folder for each source file that kernels stand in.

numba keys its cache by the file a kernel stands in, and so misses a change in a helper that the kernel calls.  A folder
here is therefore named by a hash over the file *and all that it imports*, near and far: a changed source never meets
stale machine code, and what does not depend on it stays compiled.  The path is no part of it, so that a copy of the
sources, or of the cache, finds what has been compiled.

The folders lie in `SHADOWCULL_CACHE_DIR`, else in .cache of a source tree, else in the user's cache folder; where
nothing can be written there, a temporary folder serves for the life of the process.  Those used last are kept.

What goes wrong with the cache costs time and nothing else: what cannot be read is compiled, what cannot be written is
compiled again next time.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, UserProvidedCacheLocator

from tracer.runtime.prebuilt import wanted_root

_PACKAGE = Path(__file__).parents[1]  # the tracer
_ROOT = _PACKAGE.parent  # of the packages
# What kernels are made of: nothing else in the package ends up in machine code.
_KERNEL_SOURCES = (
    "simd/", "geometry/", "culling/", "visibility/", "neighbours/", "shading/", "methods/", "inspect/ray_probe.py",
    "scene/model.py", "scene/lights.py",
)  # fmt: skip
_COMPILERS = ("runtime/kernels.py", "runtime/subkernels.py")
_STEPS = _PACKAGE / "compiling" / "steps.py"  # imports all that a program starts with
_ROOM = 1 << 25  # bytes; all kernels take a tenth of it
_KEPT = 640  # folders: those of about sixteen versions of all sources, some 3 MB each
_IMPORT = re.compile(r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[^\n#]*)|import[ \t]+([^\n#]*))", re.M)

_FOR_TYPES = re.compile(r"^if TYPE_CHECKING:\n(?:(?:[ \t]+[^\n]*)?\n)+", re.M)  # never imported


# --- what a source file depends on -----------------------------------------------------------------


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _modules(text: str) -> Iterator[str]:
    """Names of all modules that a source may import, and some that are none: `from a import b` may mean a.b."""
    for package, names, plain in _IMPORT.findall(_FOR_TYPES.sub("", text)):
        for name in (names or plain).strip("() \t\n").split(","):
            words = name.split("#")[0].split()
            if words:
                yield f"{package}.{words[0]}" if package else words[0]


@cache
def _imported(path: Path) -> frozenset[Path]:
    """The files of the tracer, and of the file's own package, that a source takes something from.

    Of a module's name that is the longest part that is a file: packages on the way to it only stand above it."""
    inside = path.relative_to(_ROOT).parts[0] if path.is_relative_to(_ROOT) else ""
    names = (module.split(".") for module in _modules(_text(path)))
    return frozenset(_file_of(parts) for parts in names if parts[0] in (_PACKAGE.name, inside)) - {_ROOT}


def _file_of(parts: list[str]) -> Path:
    """The file of a module, or else of what it would lie in."""
    for length in range(len(parts), 0, -1):
        stem = _ROOT.joinpath(*parts[:length])
        for file in (stem.with_suffix(".py"), stem / "__init__.py"):
            if file.is_file():
                return file
    return _ROOT


@cache
def sources_of(path: Path) -> frozenset[Path]:
    """A source file with all that may end up in its kernels: what it imports, near and far."""
    reached, waiting = {path}, [path]
    while waiting:
        new = _imported(waiting.pop()) - reached
        reached |= new
        waiting.extend(new)
    compilers = {_PACKAGE / name for name in _COMPILERS}
    return frozenset({file for file in reached if file == path or _may_be_compiled(file)} | compilers)


def _may_be_compiled(file: Path) -> bool:
    inside = file.is_relative_to(_PACKAGE)
    return not inside or file.relative_to(_PACKAGE).as_posix().startswith(_KERNEL_SOURCES)


def _hash(path: Path) -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for file in sorted(sources_of(path)):
        name = file.relative_to(_ROOT).as_posix() if file.is_relative_to(_ROOT) else file.name
        digest.update(name.encode() + b"\0" + _text(file).encode() + b"\0")
    return digest.hexdigest()[:16]


# --- folders ---------------------------------------------------------------------------------------

_folders: dict[Path, Path] = {}  # of the sources that this process has asked for


def folder_of(source: Path) -> Path:
    """The folder of the kernels in a source file: it is there, and has kernels in it or room for them."""
    if source not in _folders:
        _folders[source] = _make_folder(_hash(source))
    return _folders[source]


def _make_folder(name: str) -> Path:
    root = wanted_root()
    folder = root / name
    try:
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            _remove_oldest(root, folder)
        if not any(folder.iterdir()):
            if shutil.disk_usage(folder).free < _ROOM:
                raise OSError("no room")
            with tempfile.TemporaryFile(dir=folder):
                pass
    except OSError:
        folder = Path(_temporary_folder().name) / name
        folder.mkdir(exist_ok=True)
    with suppress(OSError):
        now = _clock(folder.parent)()
        os.utime(folder, (now, now))  # used now
    return folder


@cache
def _clock(root: Path) -> Callable[[], float]:
    """A clock by which now is later than when any folder was used: the system's may have been set back since."""
    with suppress(OSError):
        latest = max(entry.stat().st_mtime for entry in os.scandir(root))
        begin, started = max(time.time(), latest + 0.001), time.monotonic()
        return lambda: begin + time.monotonic() - started
    return time.time


def version_folder() -> Path:
    """The folder of this version of all that a program starts with, for notes about it."""
    return folder_of(_STEPS)


def cache_root() -> Path:
    """The folder in which this process keeps its kernels."""
    return version_folder().parent


def outlives_process() -> bool:
    """Whether compiled kernels outlive this process: else no folder could be written to."""
    return cache_root() == wanted_root()


def anything_kept() -> bool:
    """Whether any kernel that this process has asked for is in the cache."""
    return any(any(folder.glob("*.nbc")) for folder in _folders.values())


@cache
def _temporary_folder() -> tempfile.TemporaryDirectory:
    """Removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="shadowcull-kernels-", ignore_cleanup_errors=True)


def _remove_oldest(root: Path, new: Path) -> None:
    """Keep the new folder, whatever the clock says, and those that were used last; a process that still runs with
    another compiles what it has not loaded yet."""
    with suppress(OSError):
        folders = [folder for folder in root.iterdir() if re.fullmatch("[0-9a-f]{16}", folder.name) and folder != new]
        folders.sort(key=lambda folder: folder.stat().st_mtime, reverse=True)
        for folder in folders[_KEPT - 1 :]:
            shutil.rmtree(folder, ignore_errors=True)


# --- as numba asks for it --------------------------------------------------------------------------


class _Locator(UserProvidedCacheLocator):
    """Where a function's compiled code is kept."""

    def __init__(self, function: Callable, source: str) -> None:
        super().__init__(function, source)
        self._cache_path = str(folder_of(Path(source)))

    @classmethod
    def from_function(cls, function: Callable, source: str) -> _Locator:
        return cls(function, source)

    def ensure_cache_path(self) -> None:
        os.makedirs(self._cache_path, exist_ok=True)

    def get_source_stamp(self) -> str:
        """What numba compares besides: the name of the folder says it all, and a file's time nothing."""
        return os.path.basename(self._cache_path)


class _CacheImpl(CompileResultCacheImpl):
    _locator_classes: Any = (_Locator,)


def cache_of(function: Callable) -> Any:
    """The cache of a function; one that keeps nothing where its source is no file, as in a notebook's cell."""
    return KernelCache(function) if os.path.isfile(function.__code__.co_filename) else NullCache()


class KernelCache(FunctionCache):
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

        with FileLock(cache_root() / "lock", poll_interval=0.01):
            yield
