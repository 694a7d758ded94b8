"""The lights of a glTF file (KHR_lights_punctual): points, spots and directional lights.

trimesh keeps the extension's JSON, the lights with the scene and their use with the nodes.  Candela and lux say how
much light there is, but no file says how long the picture is exposed.  So all lights are scaled alike, to what half of
the model's triangles get at least: 1, as white as paper in full light, were nothing in between.

A directional light becomes a point far away that does not fall off, so that its rays are parallel within six degrees
all over the model.  Ten times the model's radius is as far as float32 carries without harm to shadows near contacts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tracer.scene.arrays import Float64, vector
from tracer.scene.bounds import ball_of
from tracer.scene.limits import LARGEST
from tracer.scene.model import Light, SceneObject

EXTENSION = "KHR_lights_punctual"
AWAY = 10.0
"""Radii of the model from its centre to a directional light."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_BRIGHTEST = 1e30
_MOST_TRIANGLES = 4096  # that the exposure is judged by


class _Unusable(Exception):
    """A light cannot be used; the message says why."""


@dataclass(frozen=True)
class _Use:
    """A node with a light: its name, its matrix (4, 4) to the world, and the number of the light."""

    node: str
    matrix: Float64
    number: Any


def punctual_lights(
    model: Any, path: Path, objects: Sequence[SceneObject], box: Float64 | None
) -> tuple[tuple[Light, ...], list[str]]:
    """The lights of a trimesh scene, none where it has none, and warnings.

    `objects` and their bounds `box` (2, 3) are what it lights."""
    declared = _json(model.metadata, list, "gltf_extensions", EXTENSION, "lights")
    lights: list[tuple[int, Light]] = []
    warnings = []
    for use in _uses(model):
        try:
            if not (isinstance(use.number, int) and 0 <= use.number < len(declared)):
                raise _Unusable("the file has no such light")
            light, left_out = _light(use, declared[use.number], box)
        except _Unusable as error:
            warnings.append(f"{path}: the light of node {use.node!a}: {error}; it is left out")
            continue
        lights.append((use.number, light))
        warnings += [f"{path}: the light {light.name!a}: {what}" for what in left_out]
    lights.sort(key=lambda entry: (entry[0], entry[1].name))
    return _exposed([light for _, light in lights], objects), warnings


def has_lights(model: Any) -> bool:
    """Whether a trimesh scene has lights, usable or not."""
    return bool(_json(model.metadata, list, "gltf_extensions", EXTENSION, "lights")) or any(True for _ in _uses(model))


def _json(value: Any, kind: type, *keys: str) -> Any:
    """What lies below some keys of parsed JSON; an empty value of this kind where that is not to be found."""
    for key in keys:
        value = value.get(key) if isinstance(value, Mapping) else None
    return value if isinstance(value, kind) else kind()


def _uses(model: Any) -> Iterator[_Use]:
    """The nodes that have a light."""
    seen: dict[str, Any] = {}
    for (above, node), edge in model.graph.transforms.edge_data.items():
        mentioned = _json(edge, dict, "metadata", "gltf_extensions", EXTENSION)
        seen[node] = mentioned
        # The parts of a mesh are nodes below its own, which bear the same mention.
        if "light" in mentioned and mentioned is not seen.get(above):
            try:
                matrix = np.asarray(model.graph[node][0], np.float64)
            except ValueError:  # trimesh drops the node of the camera, and with it the way to what is below
                matrix = np.full((4, 4), np.nan)
            yield _Use(node, matrix, mentioned["light"])


def _light(use: _Use, declared: Any, box: Float64 | None) -> tuple[Light, list[str]]:
    """A light with its intensity as the file has it, and what of it is left out."""
    kind = _json(declared, str, "type")
    if kind not in ("point", "spot", "directional"):
        raise _Unusable(f"{kind!a} is no type of light")
    if not np.isfinite(use.matrix).all():
        raise _Unusable("its place is not known")
    if np.abs(use.matrix).max() > LARGEST:
        raise _Unusable(f"it lies beyond {LARGEST:g}")
    try:
        intensity = float(declared.get("intensity", 1.0))
        with np.errstate(over="ignore"):
            color = np.array(declared.get("color", (1.0, 1.0, 1.0)), np.float64) * intensity
    except (TypeError, ValueError, OverflowError):
        raise _Unusable("its colour or intensity is not made of numbers") from None
    if color.shape != (3,) or not (np.isfinite(color).all() and (color >= 0).all()):
        raise _Unusable("its colour and intensity are not three numbers and one, of 0 or more")
    if color.max() > _BRIGHTEST:
        raise _Unusable(f"it is brighter than {_BRIGHTEST:g}")
    named = _json(declared, str, "name") or f"light {use.number}"
    name = named if use.node.isdigit() else use.node  # trimesh names nodes without one by their numbers
    if kind == "directional":
        return Light(name, _far_away(use.matrix, box), vector(color)), []
    left_out = ["a spot shines in all directions here; its cone is left out"] if kind == "spot" else []
    return Light(name, vector(use.matrix[:3, 3]), vector(color), falloff="inverse square"), left_out


def _far_away(matrix: Float64, box: Float64 | None) -> tuple[float, float, float]:
    """Where a light stands that shines along its node's -z."""
    towards = matrix[:3, 2]
    length = float(np.linalg.norm(towards))
    if not length > 0:
        raise _Unusable("its node is scaled to nothing")
    centre, radius = ball_of(box)
    return vector(centre + AWAY * radius * towards / length)


def _exposed(lights: Sequence[Light], objects: Sequence[SceneObject]) -> tuple[Light, ...]:
    """The lights, scaled alike."""
    if not lights:
        return ()
    step = max(1, sum(len(o.triangles) for o in objects) // _MOST_TRIANGLES)
    chosen, before = [np.empty((0, 3))], 0
    for o in objects:
        chosen.append(o.triangles.corners[-before % step :: step].mean(axis=1))
        before += len(o.triangles)
    centers = np.concatenate(chosen)
    arriving = np.zeros(len(centers))
    for light in lights:
        squares = np.sum((centers - light.position) ** 2, axis=1) if light.falloff != "none" else np.ones(len(centers))
        with np.errstate(all="ignore"):  # a light within the model
            arriving += np.nan_to_num(_LUMINANCE @ light.color / squares, posinf=1e30)
    usual = float(np.median(arriving)) if len(centers) else 0.0
    if not usual > 0:
        return tuple(lights)
    return tuple(replace(one, color=vector(np.minimum(np.array(one.color) / usual, _BRIGHTEST))) for one in lights)
