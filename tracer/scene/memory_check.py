"""Whether a scene fits into the memory that this machine has left: asked before reading it takes the machine down.

What reading takes is estimated from what the head of a file says, else from its size, by what was measured; what
showing takes, from the triangles that were read.  Where nobody knows what memory there is, nothing is asked.
"""

from __future__ import annotations

import json
import os
import struct
from contextlib import suppress
from pathlib import Path
from typing import Any

from tracer.scene.binary_meshes import is_plain
from tracer.scene.limits import MOST_PRIMITIVES
from tracer.scene.model import SceneError
from tracer.scene.ply import LONGEST_HEAD, read_head

ANYHOW = "SHADOWCULL_BEYOND_MEMORY"
"""A variable of the environment: set, no scene is refused for the memory that it needs."""

READING = 750.0
"""Bytes for each triangle of a mesh, at most, while it is read; READING_PLAIN where it is read a part at a time; for
each byte of a text, READING_TEXT."""
READING_PLAIN = 300.0
READING_TEXT = 25.0
SHOWING = 600.0
"""Bytes for each triangle that its tree, modes, certificates and first pictures take beside the scene."""
_SMALL = 256e6  # bytes that nobody needs to ask for
_LONGEST_JSON = 1 << 28


def check_reading(path: Path, whole: bool = False) -> None:
    """Raise SceneError, in one line, where reading this file, as a `whole` if it must be, needs more memory than there
    is."""
    with suppress(OSError):  # the reader says what is wrong
        _check(path, reading(path, whole), "to be read")


def reading(path: Path, whole: bool = False) -> float:
    """Bytes that reading this file takes at most, about; raises OSError."""
    triangles = triangles_of(path)
    if triangles is None:
        return READING_TEXT * path.stat().st_size
    return (READING_PLAIN if not whole and is_plain(path) else READING) * triangles


def check_showing(path: Path, triangles: int) -> None:
    """The same for building trees over a scene that was read, and for its first picture."""
    _check(path, SHOWING * triangles, f"more to be shown, with its {triangles:,} triangles")


def _check(path: Path, needed: float, what: str) -> None:
    if needed < _SMALL or os.environ.get(ANYHOW):
        return
    there = available()
    if there is not None and needed > there:
        short = max(needed - there, 0.05e9)
        raise SceneError(
            f"{path}: it needs about {needed / 1e9:.1f} GB of memory {what}, and {there / 1e9:.1f} GB are free: "
            f"{short / 1e9:.1f} GB too little; free some, make it simpler, or give --beyond-memory ({ANYHOW}=1)"
        )


def available() -> float | None:
    """Bytes of memory that this process may still take without another being ended; None where nobody knows."""
    found = [_of_system(), _of_group(), of_limit()]
    known = [bytes_ for bytes_ in found if bytes_ is not None]
    return max(min(known), 0.0) if known else None


def _of_system() -> float | None:
    """What the system can give away."""
    told = _field(Path("/proc/meminfo"), "MemAvailable:")
    return _elsewhere() if told is None else told


def _elsewhere() -> float | None:
    """The same on macOS and Windows."""
    try:
        import psutil
    except ImportError:  # on Linux it is not asked for
        return None
    return float(psutil.virtual_memory().available)


def _of_group() -> float | None:
    """What is left of what a container may take."""
    try:
        most = Path("/sys/fs/cgroup/memory.max").read_text().strip()
        return None if most == "max" else float(most) - float(Path("/sys/fs/cgroup/memory.current").read_text())
    except (OSError, ValueError):
        return None


def of_limit() -> float | None:
    """What is left of the addresses that this process may use, where `ulimit -v` bounds them."""
    try:
        import resource
    except ImportError:  # on Windows
        return None
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    used = _field(Path("/proc/self/status"), "VmSize:")
    return None if most == resource.RLIM_INFINITY or used is None else most - used


def _field(path: Path, name: str) -> float | None:
    """Bytes that a line of one of Linux' tables tells in KiB."""
    try:
        line = next(line for line in path.read_text().splitlines() if line.startswith(name))
        return 1024.0 * float(line.split()[1])
    except (OSError, ValueError, IndexError, StopIteration):
        return None


# --- what the head of a file says ------------------------------------------------------------------


def triangles_of(path: Path) -> int | None:
    """How many triangles a mesh file says that it has, before it is read; None for a text, or where it does not say.

    Raises OSError."""
    read = {".stl": _of_stl, ".ply": _of_ply, ".glb": _of_gltf, ".gltf": _of_gltf}.get(path.suffix.lower())
    try:
        return None if read is None else read(path)
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError, struct.error):
        return None  # damaged: the reader says so


def _of_stl(path: Path) -> int | None:
    with path.open("rb") as file:
        head = file.read(84)
    (count,) = struct.unpack("<I", head[80:84])
    return count if 84 + 50 * count == path.stat().st_size else None


def _of_ply(path: Path) -> int | None:
    with path.open("rb") as file:
        head = file.read(LONGEST_HEAD)
    found = read_head(head, most=1 << 62)
    if found is None or any(one.has_lists and one.name != "face" for one in found.elements):
        return None  # a text, or strips
    flat = sum(e.number * sum(p.kind.itemsize for p in e.properties if p.count is None) for e in found.elements)
    faces = next((one.number for one in found.elements if one.name == "face"), 0)
    corners = round(((path.stat().st_size - found.begin - flat) / faces - 1) / 4) if faces else 0  # in the mean
    triangles = faces * max(corners - 2, 1)
    return triangles if 0 <= triangles <= MOST_PRIMITIVES else None


def _of_gltf(path: Path) -> int | None:
    with path.open("rb") as file:
        if path.suffix.lower() == ".glb":
            _, _, _, length, _ = struct.unpack("<4sIIII", file.read(20))
        else:
            length = path.stat().st_size
        data: Any = json.loads(file.read(min(length, _LONGEST_JSON)))
    accessors = data.get("accessors", [])

    def triangles(mesh: Any) -> int:
        found = 0
        for primitive in mesh["primitives"]:
            corners = primitive.get("indices", primitive["attributes"]["POSITION"])
            found += accessors[corners]["count"] // (3 if primitive.get("mode", 4) == 4 else 1)
        return found

    of_meshes = [triangles(mesh) for mesh in data.get("meshes", [])]
    found = sum(of_meshes[node["mesh"]] for node in data.get("nodes", []) if "mesh" in node)
    return found if 0 <= found <= MOST_PRIMITIVES else None  # more is not read, or the file is damaged
