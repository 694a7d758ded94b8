"""Where shaders and assets are, in a source tree and in an installed wheel alike.

In the source tree `shaders/` and `assets/` lie at the top, beside the packages; a wheel carries
the same two folders inside the package, under `viewer/data/`.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from tracer.similar import did_you_mean

_PACKAGE = Path(__file__).resolve().parents[1]

DEFAULT_SCENE = "default"


@cache
def _root() -> Path:
    packaged = _PACKAGE / "data"
    return packaged if (packaged / "shaders").is_dir() else _PACKAGE.parent


def asset_path(*parts: str) -> Path:
    """Path of an asset, e.g. `asset_path("scenes", "default.aff")`; raises FileNotFoundError when absent."""
    path = _root().joinpath("assets", *parts)
    if not path.exists():
        raise FileNotFoundError(f"no such asset: {path}")
    return path


def shader_source(name: str) -> str:
    """The GLSL text of `shaders/<name>`; raises FileNotFoundError when absent."""
    return (_root() / "shaders" / name).read_text(encoding="utf-8")


def embedded_scenes() -> dict[str, Path]:
    """Name -> path of every scene that comes with the program, the default one first."""
    folder = _root() / "assets" / "scenes"
    found = {path.stem: path for path in sorted(folder.glob("*.aff"))}
    # A scene made of several files includes its parts from folders of their own, so that each file here is a scene.
    default = found.pop(DEFAULT_SCENE, None)
    return ({DEFAULT_SCENE: default} if default else {}) | found


def default_scene() -> Path:
    """The room that opens when no scene is named."""
    return asset_path("scenes", f"{DEFAULT_SCENE}.aff")


def scene_path(name: str | None) -> Path:
    """The file that a name means: a path, the name of a scene that comes with the program, or by default its room.

    Raises OSError, in one line, for what is neither, but like the name of such a scene."""
    if name is None:
        return default_scene()
    own, path = embedded_scenes(), Path(name)
    if name not in own and not path.suffix and not os.path.lexists(path):
        hint = did_you_mean(name, own)
        if hint:
            raise OSError(f"{name}: no such file, and no scene of the program{hint}")
    return own.get(name) or path
