"""Where shaders and scenes are, in a source tree and in an installed wheel alike.

In the source tree `shaders/` and `assets/` lie at the top, beside the packages; a wheel carries
the same two folders inside the package, under `viewer/data/`."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from tracer.util.suggest import did_you_mean

DEFAULT_SCENE = "default"


@cache
def _root() -> Path:
    package = Path(__file__).resolve().parents[1]
    packaged = package / "data"
    return packaged if (packaged / "shaders").is_dir() else package.parent


def shader_source(name: str) -> str:
    """Return the GLSL text of `shaders/<name>`; raises FileNotFoundError when absent."""
    return (_root() / "shaders" / name).read_text(encoding="utf-8")


@cache
def embedded_scenes() -> dict[str, Path]:
    """Return name and path of every scene that comes with the program, the default one first; parts of scenes lie in
    folders of their own."""
    found = {path.stem: path for path in (_root() / "assets" / "scenes").glob("*.aff")}
    return dict(sorted(found.items(), key=lambda one: (one[0] != DEFAULT_SCENE, one[0])))


def default_scene() -> Path:
    """Return the room that opens when no scene is named."""
    return embedded_scenes()[DEFAULT_SCENE]


def scene_path(name: str | None) -> Path:
    """Return the file that a name means: a path, the name of a scene of the program, or by default its room; raises
    OSError, in one line, for what is neither, but like the name of such a scene."""
    own, path = embedded_scenes(), Path(name or DEFAULT_SCENE)
    if name is None or name in own:
        return own[name or DEFAULT_SCENE]
    if not path.suffix and not os.path.lexists(path) and (hint := did_you_mean(name, own)):
        raise OSError(f"{name}: no such file, and no scene of the program{hint}")
    return path


def documentation(page: str) -> Path | None:
    """Return a page of the documentation: as it was built, else as it is written; None where neither is there."""
    built, written = _root() / "build" / "docs" / f"{page}.html", _root() / "docs" / f"{page}.md"
    return next((path for path in (built, written) if path.is_file()), None)
