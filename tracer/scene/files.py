"""The files of a scene, which may come from a stranger: only regular ones, only below its folder, only so large.

What a scene names is opened by its true path, past all links, so that neither `..` nor a link leads elsewhere.  What is
refused is refused before anything of it is read.
"""

from __future__ import annotations

import os
import stat
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from tracer.scene.limits import MOST_BYTES

Stamp = tuple[int, int] | None
"""When a file was changed last, in nanoseconds, and its bytes: another stamp is another file.  None: it is missing."""

_noted = threading.local()


@contextmanager
def noting(files: dict[Path, Stamp]) -> Iterator[None]:
    """Put all files that this thread reads for a scene meanwhile into `files`, with the stamps of what was read; those
    that were missed as well."""
    before = getattr(_noted, "files", None)
    _noted.files = files
    try:
        yield
    finally:
        _noted.files = before


def note(path: Path, found: os.stat_result | None) -> None:
    """Say that a scene was read from this file, or that it was missed."""
    files: dict[Path, Stamp] | None = getattr(_noted, "files", None)
    if files is not None:
        files[path.absolute()] = None if found is None else (found.st_mtime_ns, found.st_size)


def stamp(path: Path) -> Stamp:
    """That of a file as it is now."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return found.st_mtime_ns, found.st_size


@contextmanager
def open_regular(path: Path) -> Iterator[BinaryIO]:
    """A regular file, to be read; raises OSError or ValueError (a name that no file can have)."""
    if path.is_dir():
        raise IsADirectoryError(0, "it is a folder, not a file")
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)  # opening a pipe would wait
    try:
        descriptor = os.open(path, flags)
    except FileNotFoundError:
        note(path, None)
        raise
    with open(descriptor, "rb") as file:
        found = os.fstat(file.fileno())
        note(path, found)
        if not stat.S_ISREG(found.st_mode):
            raise OSError(0, "it is not a regular file")
        yield file


def read_regular(path: Path, most: int = MOST_BYTES) -> bytes:
    """All of a regular file; raises OSError or ValueError (a name that no file can have)."""
    with open_regular(path) as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(0, f"it is too large; {most >> 20} MiB are read at most")
    return data


class SceneFiles:
    """Reads what a scene names, from its folder and `folders` that the user has named, and MOST_BYTES in all."""

    def __init__(self, scene: Path, folders: Iterable[Path] = ()) -> None:
        # A link to a scene may stand among links to its parts as well as lead to where they are.
        own = (scene.absolute().parent, scene.resolve().parent)
        self.roots = tuple(dict.fromkeys(f.resolve() for f in (*own, *folders)))
        self._left = MOST_BYTES

    def holds(self, path: Path) -> bool:
        """Whether a file lies truly below one of the folders; raises OSError or ValueError where none can be."""
        true = path.resolve()
        return any(true.is_relative_to(root) for root in self.roots)

    def read(self, path: Path) -> bytes:
        """All of a file that a scene names; raises OSError or ValueError."""
        if not self.holds(path):
            raise PermissionError(0, "it lies outside of the scene's folder, which --folder can add to")
        data = read_regular(path, self._left)
        self._left -= len(data)
        return data
