"""Trials: a few frames of a scene in which one thing changes, and all else stands still."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tracer.editing.edits import Edits, edited
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.arrays import vector
from tracer.scene.model import Scene
from tracer.scene.things import things

NOTHING, CAMERA, LIGHTS, OBJECTS, RESTS = CHANGES = (
    "nothing moves", "the camera moves", "lights move", "objects move", "objects start and stop"
)  # fmt: skip
"""What changes in a trial."""
FEWEST = 4
"""Frames of a trial."""
_DRIFT = 0.2  # how far a light moves, as a part of its distance from the camera


@dataclass(frozen=True)
class Trial:
    """Frames of a scene at some times, and what changes in them."""

    change: str
    scene: Scene
    times: list[float]

    def __str__(self) -> str:
        return f"{self.scene.path.stem}, {self.change}"


def trials(scene: Scene, first: int, frames: int) -> list[Trial]:
    """One trial for each of `CHANGES` that the scene can show, each of so many frames, from one of its path on.

    Raises ValueError for fewer than `FEWEST`: with pauses, nothing would move."""
    if frames < FEWEST:
        raise ValueError(f"a trial has {FEWEST} frames at least, not {frames}")
    start = scene.frame_time(max(0, min(first, scene.frames - frames)))
    step = scene.frame_time(1) - scene.frame_time(0) or 1.0
    going = [start + number * step for number in range(frames)]
    # Every other moment is seen three times, so that something is learnt before it no longer holds.
    pausing = [start + (2 * (number // 4) + (number % 4 == 3)) * step for number in range(frames)]
    places = scene.light_positions(start)
    lights = [replace(light, position=vector(p), track=None) for light, p in zip(scene.lights, places, strict=True)]
    scene = replace(scene, lights=tuple(lights))
    movers = [thing.name for thing in things(scene) if thing.moves]
    static = edited(scene, Edits(static=tuple((name, start) for name in movers))).scene
    seen = _seen_from(scene, start)
    found = [Trial(NOTHING, seen, [start] * frames)]
    if "camera" in scene.animation.tracks:
        found.append(Trial(CAMERA, static, going))
    if lights:
        found.append(Trial(LIGHTS, _with_drifting_lights(_seen_from(static, start), start, pausing[-1]), pausing))
    if movers:
        found += [Trial(OBJECTS, seen, going), Trial(RESTS, seen, pausing)]
    return found


def _seen_from(scene: Scene, time: float) -> Scene:
    """A scene that is seen from where its camera is at a time."""
    tracks = {name: track for name, track in scene.animation.tracks.items() if name != "camera"}
    return replace(scene, camera=scene.camera_at(time), animation=Animation(tracks))


def _with_drifting_lights(scene: Scene, start: float, end: float) -> Scene:
    """A scene in which every other light moves aside as seen by the camera, to the right and to the left in turn."""
    aside, at = np.asarray(scene.camera.basis()[0]), np.arange(-1.0, 3.0)  # keys, of which the inner two are met
    tracks, lights = dict(scene.animation.tracks), list(scene.lights)
    for number in range(0, len(lights), 2):
        distance = np.linalg.norm(np.subtract(lights[number].position, scene.camera.position))
        way = (-1.0) ** (number // 2) * _DRIFT * distance * aside
        keys = Keys(start + at * (end - start), np.outer(at, way), np.zeros((len(at), 3)))
        lights[number] = replace(lights[number], track=f"drift_{number}")
        tracks[f"drift_{number}"] = TrackSet(translation=keys)
    return replace(scene, lights=tuple(lights), animation=Animation(tracks))
