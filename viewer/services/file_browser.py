"""The state of the dialog that opens a file: what a folder offers, which entry is meant, how a name is completed."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path

from tracer.scene.model import Progress
from viewer.output import capture
from viewer.services import scene_files
from viewer.services.jobs import Job

_LOOKED_AT = 1 << 18  # bytes of a file in which the camera is looked for
_COMMENT = re.compile(rb"[#%][^\n]*")
_CAMERA = re.compile(rb"(?<![^\s{}])v\s+(?:from|at|up|angle|hither|resolution)\s")


class Kind(IntEnum):
    """What can be opened, in the order in which it is listed."""

    FOLDER = 0
    SCENE = 1
    PICTURE = 2
    PART = 3


@dataclass(frozen=True)
class Entry:
    """One line of the list; the name of a folder ends in a slash."""

    name: str
    path: Path
    kind: Kind


Known = dict[Path, tuple[int, int, Kind | None]]  # a file's time of change in ns, its size in bytes, what it was then


def kind_of(file: Path) -> Kind | None:
    """What a file is, by its ending and by what is in it; None if it cannot be opened.  Raises OSError.

    An AFF file without a camera of its own is a part, made to be included by others."""
    if scene_files.is_capture(file):
        return Kind.PICTURE if capture.carries_state(file) else None
    if not scene_files.is_scene(file):
        return None
    return Kind.PART if file.suffix.lower() == ".aff" and not _has_camera(file) else Kind.SCENE


def _has_camera(file: Path) -> bool:
    with file.open("rb") as stream:
        return _CAMERA.search(_COMMENT.sub(b"", stream.read(_LOOKED_AT))) is not None


def entries(folder: Path, known: Known, progress: Progress) -> list[Entry]:
    """Folders, and files that can be opened; files that have not changed since they became `known` are not read.

    Raises OSError, and what `progress` raises."""
    found = []
    with os.scandir(folder) as scanned:
        for item in scanned:
            progress(item.name, 0.0)
            path = folder / item.name
            try:
                if item.is_dir():
                    found.append(Entry(f"{item.name}/", path, Kind.FOLDER))
                elif item.is_file() and (kind := _known_kind(path, item.stat(), known)) is not None:
                    found.append(Entry(item.name, path, kind))
            except OSError:  # gone meanwhile, or not ours to read
                continue
    return sorted(found, key=lambda e: (e.kind, e.name.lower(), e.name))


def _known_kind(path: Path, now: os.stat_result, known: Known) -> Kind | None:
    before = known.get(path)
    if before is None or before[:2] != (now.st_mtime_ns, now.st_size):
        before = known[path] = (now.st_mtime_ns, now.st_size, kind_of(path))
    return before[2]


def completed(name: str, names: list[str]) -> str:
    """The longest beginning that all names have in common which begin so, in any case if none does in this one."""
    begun = [n for n in names if n.startswith(name)] or [n for n in names if n.lower().startswith(name.lower())]
    common = os.path.commonprefix(begun)  # noqa: RUF071 - character by character is what is meant
    return common if len(common) >= len(name) else name


@dataclass
class Browser:
    """The dialog's state: whether it is up, its folder, what was typed, the line that is marked, what went wrong."""

    open: bool = False
    folder: Path = field(default_factory=Path.cwd)
    typed: str = ""
    marked: str = ""
    problem: str = ""
    _known: Known = field(default_factory=dict)
    _wanted: tuple[Path, int] | None = None
    _job: Job[list[Entry]] | None = None
    _listed: tuple[Path, list[Entry]] | None = None

    def begin(self) -> None:
        """Open again, in the same folder."""
        self.enter(self.folder)
        self._wanted = None

    def enter(self, folder: Path) -> None:
        self.folder = Path(os.path.abspath(folder))
        self.type("")

    def type(self, text: str) -> None:
        self.typed, self.marked, self.problem = text, "", ""

    def follow(self, wake: Callable[[], None]) -> None:
        """Have the folder read beside the window where it is another one or has changed, and take what was found."""
        folder = self._place()[0]
        try:
            wanted = folder, folder.stat().st_mtime_ns
        except OSError:
            wanted = folder, 0
        if wanted != self._wanted:
            if self._job is not None:
                self._job.cancel()
            self._wanted = wanted
            self._job = Job(f"Reading {folder}", lambda progress: entries(folder, self._known, progress), wake)
        if self._job is not None and self._job.done:
            job, self._job = self._job, None
            self._listed = folder, job.result or []
            if job.failure is not None:
                self.problem = f"{folder}: {job.failure.text}"

    @property
    def reading(self) -> bool:
        """Whether the folder that is meant has not been read yet."""
        return self._listed is None or self._listed[0] != self._place()[0]

    def shown(self) -> list[Entry]:
        """What of the folder has the last part of what was typed in its name."""
        part = self._place()[1]
        hidden = part.startswith(".")
        return [e for e in self._all() if part.lower() in e.name.lower() and (hidden or not e.name.startswith("."))]

    def aimed(self) -> Entry | None:
        """The line that Enter takes: the marked one, the one that was typed, or the only one left."""
        shown, part = self.shown(), self._place()[1]
        by_name = {e.name.rstrip("/"): e for e in shown}
        only = shown[0] if part and len(shown) == 1 else None
        return by_name.get(self.marked.rstrip("/")) or by_name.get(part) or only

    def step(self, by: int) -> None:
        """Mark the next line (1) or the one before (-1); from none, the first or the last."""
        names, aimed = [e.name for e in self.shown()], self.aimed()
        if names:
            start = names.index(aimed.name) if aimed is not None else (-1 if by > 0 else len(names))
            self.marked = names[min(max(start + by, 0), len(names) - 1)]

    def completed(self) -> str:
        """What was typed, completed as far as the names in the folder agree."""
        text, part = self.typed.strip(), self._place()[1]
        if text == "~" or part in (".", ".."):
            return f"{text}/"
        visible = [e.name for e in self._all() if part.startswith(".") or not e.name.startswith(".")]
        return text.removesuffix(part) + completed(part, visible)

    def meant(self) -> Path | None:
        """What Enter opens: the line aimed at, or any path that was typed."""
        aimed, text = self.aimed(), self.typed.strip()
        if aimed is not None:
            return aimed.path
        return self.folder / os.path.expanduser(text) if text else None

    def take(self, path: Path) -> Path | None:
        """Go into a folder, or return a file that can be opened; else `problem` says why not."""
        if os.path.isdir(path):
            self.enter(path)
            return None
        self.problem = _refusal(path) or ""
        if self.problem:
            return None
        self.enter(path.parent)
        self.open = False
        return path

    def _place(self) -> tuple[Path, str]:
        """The folder in which what was typed is looked for, and its last part."""
        text = self.typed.strip()
        start = text.rfind("/") + 1
        return self.folder / os.path.expanduser(text[:start]), text[start:]

    def _all(self) -> list[Entry]:
        return [] if self._listed is None or self.reading else self._listed[1]


def _refusal(path: Path) -> str | None:
    try:
        refused = scene_files.refusal(path)
        if refused is None and kind_of(path) is None:
            return f"{path.name}: a picture, but not one captured by Shadowcull"
        return refused
    except OSError as error:
        return f"{path.name}: {error.strerror or error}"
