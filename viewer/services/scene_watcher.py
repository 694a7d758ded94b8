"""Reloads the scene when a file changes that it was read from: the scene itself, what it includes, textures, meshes.

Files are looked at now and then on a thread, by the time of their last change and their size.  What has changed is read
once it has stayed the same from one look to the next, so that nothing is read that is half-written."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path

from tracer.scene.files import Stamp, stamp
from viewer.state.preferences import Preferences

EVERY = 0.35
"""Seconds from look to look."""


class SceneWatcher:
    """`reload(names)` is called by `reload_changed` when files have changed, of which the names are given."""

    def __init__(
        self,
        preferences: Preferences,
        files: Callable[[], Mapping[Path, Stamp]],
        may: Callable[[], bool],
        reload: Callable[[str], None],
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        """`files` returns those that the open scene was read from, as they were then; `may` says whether a scene can be
        read now."""
        self._preferences, self._files, self._may, self._reload = preferences, files, may, reload
        self._wake = wake
        self._watched: Mapping[Path, Stamp] = {}
        self._seen: dict[Path, Stamp] = {}
        self._known: dict[Path, Stamp] = {}
        self._changed = ""
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def reload_changed(self) -> None:
        """Take up what the scene was read from, and have it read again where that has changed."""
        files = self._files()
        with self._lock:
            if files is not self._watched:
                self._watched, self._changed = files, ""
                self._known, self._seen = dict(files), dict(files)
            wanted = self._changed if self._preferences.watch_scene else ""
        if self._preferences.watch_scene and files and self._thread is None:
            self._thread = threading.Thread(target=self._run, name="shadowcull watching the scene", daemon=True)
            self._thread.start()
        if wanted and self._may():
            with self._lock:
                self._known, self._changed = dict(self._seen), ""
            self._reload(wanted)

    def look(self) -> None:
        """Look at all files once."""
        with self._lock:
            watched, before = self._watched, self._seen
        now = {path: stamp(path) for path in watched}
        with self._lock:
            if watched is not self._watched:
                return
            self._seen = now
            changed = [path for path in now if now[path] != self._known[path]]
            # What has gone may be about to be replaced, as many programs write files.
            still = now == before and not any(now[path] is None and self._known[path] is not None for path in now)
            self._changed = _in_words(changed) if changed and still else ""
            wanted = bool(self._changed)
        if wanted and self._preferences.watch_scene:
            self._wake()

    def close(self) -> None:
        """End the thread; what it is looking at takes no longer than a look."""
        self._stop.set()

    def _run(self) -> None:
        while not self._stop.wait(EVERY):
            if self._preferences.watch_scene:
                self.look()


def _in_words(changed: list[Path]) -> str:
    more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
    return f"{changed[0].name}{more}"
