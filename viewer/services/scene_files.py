"""Which files can be opened, where the scene of a saved picture is now, and which files of a scene have changed."""

from __future__ import annotations

import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from tracer.scene.files import Stamp, stamp
from viewer.util import resources

LOOK_SECONDS = 0.35
"""From one look at a scene's files to the next."""
SCENE_SUFFIXES = (".aff", ".nff", ".obj", ".ply", ".stl", ".gltf", ".glb")
CAPTURE_SUFFIXES = (".png",)


def is_capture(path: Path) -> bool:
    return path.suffix.lower() in CAPTURE_SUFFIXES


def refusal(path: Path) -> str | None:
    """Why a path cannot be opened, in one line; None if it is worth trying."""
    if path.is_dir():
        return f"{path}: a folder; open a scene ({' '.join(SCENE_SUFFIXES)}) or a saved picture (.png)"
    if path.suffix.lower() not in SCENE_SUFFIXES + CAPTURE_SUFFIXES:
        return f"{path.name}: neither a scene ({' '.join(SCENE_SUFFIXES)}) nor a saved picture (.png)"
    return None if path.exists() else f"{path}: no such file"


def find_scene(stored: str, picture: Path) -> Path | None:
    """Where a saved picture's scene is now: at its old path, beside the picture, or among our own scenes."""
    path = Path(stored)
    candidates = [path, picture.parent / path.name]
    embedded = resources.embedded_scenes().get(path.stem)
    if embedded is not None and (stored == path.stem or path.parent.name == embedded.parent.name):
        candidates.append(embedded)
    try:
        return next((c for c in candidates if c.is_file()), None)
    except OSError:  # no name that a file can have
        return None


class FileWatch:
    """Looks at `files`, as they were read, by the time of their last change and their size."""

    def __init__(self) -> None:
        self.files: dict[Path, Stamp] = {}
        self._seen: dict[Path, Stamp] = {}
        self._worker = ThreadPoolExecutor(1, "shadowcull watching the scene")
        self._look: Future[dict[Path, Stamp]] | None = None
        self._next = 0.0

    def changed(self) -> str:
        """Name what has changed since it was read, or was named last; "" for nothing.

        To be called in each frame of the window, which does not wait for a disk.  What has changed is told once it has
        stayed the same from one look to the next, so that nothing is read that is half-written."""
        if self._look is None:
            if self.files and time.monotonic() >= self._next:
                self._look = self._worker.submit(lambda paths: {path: stamp(path) for path in paths}, tuple(self.files))
            return ""
        if not self._look.done():
            return ""
        now, before = self._look.result(), self._seen
        self._look, self._seen, self._next = None, now, time.monotonic() + LOOK_SECONDS
        if now != before or now.keys() != self.files.keys():
            return ""
        changed = [path for path in now if now[path] != self.files[path]]
        # What has gone may be about to be replaced, as many programs write files.
        if not changed or any(now[path] is None and self.files[path] is not None for path in changed):
            return ""
        self.files = now
        return f"{changed[0].name}{f' and {len(changed) - 1} more' if len(changed) > 1 else ''}"
