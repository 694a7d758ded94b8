"""Loading a scene file of any kind, by its extension, and a summary of a scene in a few numbers."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from tracer.scene.aff import load_aff
from tracer.scene.bounds import bounds
from tracer.scene.memory_check import check_reading, check_showing
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.meshes import MESH_EXTENSIONS, load_mesh
from tracer.scene.model import CONE, SPHERE, Progress, Scene, SceneError
from tracer.util.suggest import did_you_mean_file

AFF_EXTENSIONS = (".aff", ".nff")
SCENE_EXTENSIONS = (*AFF_EXTENSIONS, *MESH_EXTENSIONS)


def load_scene(
    path: str | Path, progress: Progress | None = None, folders: Iterable[Path] = (), meshes: MeshOptions = AS_IN_FILE
) -> Scene:
    """Read a scene from a file: AFF, NFF, OBJ, PLY, STL, glTF or GLB.

    Parameters
    ----------
    path : str or Path
        The file.
    progress : callable, optional
        Called with what is done and the fraction done (0 to 1). It may raise Cancelled to stop.
    folders : iterable of Path
        Folders besides its own that the scene may read files from.
    meshes : MeshOptions
        How meshes are read: whether a model that comes alone is set in a studio, which way is up, and which edges are
        rounded. By default nothing is added to what the file holds.

    Returns
    -------
    Scene
        What the file holds. Its `warnings` name what is missing, such as a texture.

    Raises
    ------
    SceneError
        If the file cannot be read. The message is one line that names the file, its line if it has lines, and what to
        do. So is a file that needs more memory than there is, unless SHADOWCULL_BEYOND_MEMORY is set.
    """
    path = Path(path)
    check_scene_file(path)
    check_reading(path)
    if progress is not None:
        progress(f"Reading {path.name}", 0.0)
    if path.suffix.lower() in AFF_EXTENSIONS:
        scene = load_aff(path, progress, folders=folders)
    else:
        scene = load_mesh(path, progress, folders, meshes)
    if progress is not None:
        progress(f"Read {path.name}", 1.0)
    return scene


def check_scene_file(path: Path) -> None:
    """Raise SceneError, in one line, for a path that is not a file that can be read, of a kind that scenes have."""
    try:
        if path.is_dir():
            raise SceneError(f"{path}: it is a folder; give a file in it")
        if not path.exists():
            raise SceneError(f"{path}: no such file{did_you_mean_file(path)}")
        if not path.is_file():
            raise SceneError(f"{path}: cannot be read: it is not a regular file; check the path")
        if not os.access(path, os.R_OK):
            raise SceneError(f"{path}: reading it is not permitted; change its permissions")
    except (OSError, ValueError):
        raise SceneError(f"{str(path)!a}: no file can bear this name; check the path") from None
    if path.suffix.lower() not in SCENE_EXTENSIONS:
        known = ", ".join(e[1:] for e in SCENE_EXTENSIONS)
        raise SceneError(f"{path}: unknown kind of scene; give a file of one of these kinds: {known}")


def load_visible_scene(
    path: str | Path, progress: Progress | None = None, folders: Iterable[Path] = (), meshes: MeshOptions = AS_IN_FILE
) -> Scene:
    """As `load_scene`, but a scene with nothing to see in it, or too large to be shown, is a SceneError too."""
    scene = load_scene(path, progress, folders, meshes)
    if scene.primitive_count == 0:
        dropped = next((warning for warning in scene.warnings if " is dropped; " in warning), None)
        why = f"{dropped}; nothing else is to be seen" if dropped is not None else ""
        raise SceneError(why or f"{path}: nothing to see in it: no triangles, spheres or cones")
    check_showing(Path(path), scene.primitive_count)
    return scene


def scene_info(scene: Scene) -> dict[str, Any]:
    """Say what a scene contains, as `shadowcull info --json` prints it.

    Parameters
    ----------
    scene : Scene
        A scene.

    Returns
    -------
    dict
        Plain lists and numbers. `dynamic_triangles` are those of objects that can move or deform, `materials` counts
        every material statement that was run, `textures` counts different images, and `bounds` is [lower corner, upper
        corner] of everything at the start time, or None for an empty scene. `light_kinds` lists lights that are alike,
        in the order of the scene: their `kind`, their `samples`, their `falloff`, and how many `lights` there are.
    """
    kinds = np.concatenate([o.quadrics.kind for o in scene.objects])
    static = len(scene.objects[0].triangles)
    box = bounds(scene.objects, scene.animation, scene.time_range[0])
    alike = Counter((light.kind, light.samples, light.falloff) for light in scene.lights)
    return {
        "triangles": scene.triangle_count,
        "static_triangles": static,
        "dynamic_triangles": scene.triangle_count - static,
        "spheres": int(np.sum(kinds == SPHERE)),
        "cones": int(np.sum(kinds == CONE)),
        "lights": len(scene.lights),
        "materials": len(scene.materials),
        "textures": len(scene.textures),
        "frames": scene.frames,
        "time": list(scene.time_range),
        "bounds": None if box is None else box.tolist(),
        "warnings": list(scene.warnings),
        "light_kinds": [
            {"kind": kind, "samples": samples, "falloff": falloff, "lights": number}
            for (kind, samples, falloff), number in alike.items()
        ],
    }
