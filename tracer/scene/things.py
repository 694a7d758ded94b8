"""What people call objects: those of a scene that can move, and the parts of what never moves, each by its name."""

from __future__ import annotations

import weakref
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Int32
from tracer.scene.model import Scene

Held = tuple[NDArray[np.intp], NDArray[np.intp]]
"""The numbers of an object's triangles, and of its quadrics, in the scene as it was read."""


@dataclass(frozen=True)
class Thing:
    """What people call an object: a dynamic object of a scene, or a part of what never moves.

    name is no other thing's; index is the object's in `Scene.objects`, part its number in `SceneObject.parts`, -1 for
    all of an object."""

    name: str
    index: int
    part: int = -1

    @property
    def moves(self) -> bool:
        """Whether it is an object that can move."""
        return self.index > 0


Made = TypeVar("Made")


def once_per_scene(make: Callable[[Scene], Made]) -> Callable[[Scene], Made]:
    """Keep what a function makes of a scene for as long as the scene is in use."""
    known: dict[int, tuple[weakref.ref[Scene], Made]] = {}  # by identity, as arrays have no hash

    @wraps(make)
    def kept(scene: Scene) -> Made:
        key = id(scene)
        found = known.get(key)
        if found is None or found[0]() is not scene:
            found = known[key] = weakref.ref(scene, lambda _: known.pop(key, None)), make(scene)
        return found[1]

    return kept


@once_per_scene
def things(scene: Scene) -> tuple[Thing, ...]:
    """All things of a scene, each with a name that no other has: first the parts of what never moves, then the objects
    that can move."""
    found: list[tuple[str, int, int]] = []
    for index, one in enumerate(scene.objects):
        if one.part_of is not None:
            found += [(name or "static", index, part) for part, name in enumerate(one.parts)]
        elif len(one.triangles) or len(one.quadrics):
            found.append((one.name or f"object {index}", index, -1))
    taken = Counter(name for name, _, _ in found)
    seen: Counter[str] = Counter()
    made = []
    for name, index, part in found:
        seen[name] += 1
        number, unique = seen[name], name
        while number > 1 and taken[unique := f"{name} #{number}"]:
            number += 1
        taken[unique] += 1
        made.append(Thing(unique, index, part))
    return tuple(made)


def thing_of(scene: Scene, primitive: int) -> Thing:
    """The thing that holds a primitive."""
    owner = owner_of(scene, primitive)
    return next(thing for thing in things(scene) if (thing.index, thing.part) == owner)


def owner_of(scene: Scene, primitive: int) -> tuple[int, int]:
    """The object that holds a primitive, and the part of it, -1 for all."""
    held, place = scene.place_of(primitive)
    return scene.object_of(primitive), -1 if held.part_of is None else int(held.part_of[place])


def thing_numbers(scene: Scene) -> Int32:
    """(primitives,) int32: the place of each primitive's thing among all `things`."""
    places = {(thing.index, thing.part): n for n, thing in enumerate(things(scene))}
    found = np.empty(scene.primitive_count, np.int32)
    for index, one in enumerate(scene.objects):
        held = np.concatenate(held_by(scene, index))
        if one.part_of is None:
            found[held] = places.get((index, -1), -1)
        else:
            found[held] = np.array([places[index, part] for part in range(len(one.parts))], np.int32)[one.part_of]
    return found


def held_by(scene: Scene, index: int) -> Held:
    """Which primitives are those of an object."""
    first, last = scene.triangle_offsets[index : index + 2]
    begin, end = scene.quadric_offsets[index : index + 2]
    return np.arange(first, last), np.arange(begin, end)
