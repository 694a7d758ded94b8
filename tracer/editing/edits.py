"""What if: a scene without some lights or objects, with lights elsewhere, with objects that are static or can move.

`edited` makes another scene of a scene and leaves that as it is.  Objects go by the names of `things`, lights and
primitives by the numbers that they have in the scene as it was read, so that edits mean the same whatever else is
edited.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.scene.animation import Animation, TrackSet
from tracer.scene.arrays import Float64, Int32, Vector
from tracer.scene.assembly import under_matrix
from tracer.scene.deformation import deformed
from tracer.scene.fingerprint import code_of
from tracer.scene.lights import Light
from tracer.scene.model import Quadrics, Scene, SceneObject, Triangles
from tracer.scene.normals import unit_normals
from tracer.scene.things import Held, Thing, held_by, owner_of, things

NEVER = "(hidden)"
"""The name of a track that shows nothing."""


@dataclass(frozen=True)
class Edits:
    """What is otherwise than in the scene as it was read.

    lights_off are numbers of lights, moved_lights where others are instead, as (number, (x, y, z)) in their order;
    hidden are names of things, hidden_primitives numbers of primitives; static are things that could move and do not,
    as (name, time in seconds) in their order: they stay where they are then; moving are names of static things that
    can move, although they stay where they are."""

    lights_off: frozenset[int] = frozenset()
    moved_lights: tuple[tuple[int, Vector], ...] = ()
    hidden: frozenset[str] = frozenset()
    hidden_primitives: frozenset[int] = frozenset()
    static: tuple[tuple[str, float], ...] = ()
    moving: frozenset[str] = frozenset()

    def __bool__(self) -> bool:
        return self != NO_EDITS

    def with_light(self, number: int, on: bool) -> Edits:
        """With a light on or off."""
        return replace(self, lights_off=self.lights_off - {number} if on else self.lights_off | {number})

    def with_light_at(self, number: int, place: Vector | None) -> Edits:
        """With a light elsewhere, None for where it was."""
        places = {n: p for n, p in self.moved_lights if n != number}
        if place is not None:
            places[number] = place
        return replace(self, moved_lights=tuple(sorted(places.items())))

    def with_thing(self, name: str, shown: bool) -> Edits:
        """With a thing shown or hidden."""
        return replace(self, hidden=self.hidden - {name} if shown else self.hidden | {name})

    def with_primitive(self, number: int, shown: bool) -> Edits:
        """With a primitive shown or hidden."""
        kept = self.hidden_primitives
        return replace(self, hidden_primitives=kept - {number} if shown else kept | {number})

    def with_static(self, name: str, time: float | None) -> Edits:
        """With an object that stays where it is at a time, None for one that moves as in the scene."""
        times = {n: t for n, t in self.static if n != name}
        if time is not None:
            times[name] = time
        return replace(self, static=tuple(sorted(times.items())))

    def with_moving(self, name: str, moving: bool) -> Edits:
        """With a static thing that can move, or cannot."""
        return replace(self, moving=self.moving | {name} if moving else self.moving - {name})

    def light_place(self, number: int) -> Vector | None:
        """Where a light is instead; None where it was not moved."""
        return dict(self.moved_lights).get(number)

    def light_number(self, index: int) -> int:
        """The number in the scene as it was read of the light that is number `index` of those that are on."""
        number = index
        for off in sorted(self.lights_off):
            number += off <= number
        return number

    def light_index(self, number: int) -> int | None:
        """The inverse: which of the lights that are on it is; None for one that is off."""
        return None if number in self.lights_off else number - sum(off < number for off in self.lights_off)

    def within(self, scene: Scene) -> Edits:
        """Those of these edits that mean something in a scene: whose lights, things and primitives it has."""
        known = {thing.name: thing for thing in things(scene)}
        lights = len(scene.lights)
        return Edits(
            frozenset(n for n in self.lights_off if 0 <= n < lights),
            tuple((n, p) for n, p in self.moved_lights if 0 <= n < lights),
            self.hidden & frozenset(known),
            frozenset(n for n in self.hidden_primitives if 0 <= n < scene.primitive_count),
            tuple((name, time) for name, time in self.static if name in known and known[name].moves),
            frozenset(name for name in self.moving if name in known and not known[name].moves),
        )


NO_EDITS = Edits()


@dataclass(frozen=True)
class Edited:
    """A scene as edits leave it, and which of the numbers of the scene as it was read its own are.

    primitives (n,) int32 and lights (l,) int32 hold for each of its own the number in the `original`."""

    original: Scene = field(repr=False)
    edits: Edits
    scene: Scene = field(repr=False)
    primitives: Int32 = field(repr=False)
    lights: Int32 = field(repr=False)

    @cached_property
    def numbers(self) -> Int32:
        """(primitives of the original,) int32: the number that each has here, -1 for those that are not here."""
        found = np.full(self.original.primitive_count, -1, np.int32)
        found[self.primitives] = np.arange(len(self.primitives), dtype=np.int32)
        return found

    def made_as(self, other: Edited) -> bool:
        """Whether the primitives and the lights of another edited scene have the same numbers."""
        same = np.array_equal(self.primitives, other.primitives) and np.array_equal(self.lights, other.lights)
        return same and self.original is other.original

    def light_here(self, number: int) -> int:
        """The number here of a light of the original; -1 where it is off."""
        (found,) = np.nonzero(self.lights == number)
        return int(found[0]) if len(found) else -1

    @cached_property
    def _things(self) -> dict[tuple[int, int], Thing]:
        return {(thing.index, thing.part): thing for thing in things(self.original)}

    def thing_of(self, primitive: int) -> Thing:
        """The thing that holds a primitive of this scene."""
        return self._things[owner_of(self.original, int(self.primitives[primitive]))]


def edited(scene: Scene, edits: Edits) -> Edited:
    """A scene as edits leave it; what they name and the scene does not have changes nothing.

    Objects that only become hidden stay in their places, so that a world of the one scene is one of the other."""
    edits = edits.within(scene)
    numbers = np.arange(scene.primitive_count, dtype=np.int32)
    on = set(range(len(scene.lights))) - edits.lights_off
    lights = np.array(sorted(on), np.int32)
    if not edits:
        return Edited(scene, edits, scene, numbers, lights)
    objects, held = _objects(scene, edits)
    triangles, quadrics = ([numbers[part] for part in parts] for parts in zip(*held, strict=True))
    animation = scene.animation
    if any(isinstance(element, str) and element == NEVER for one in objects for element in one.chain[:1]):
        never = TrackSet(visibility=np.array([[-np.inf, 0.0]]))
        animation = Animation({**animation.tracks, NEVER: never})
    made = replace(scene, objects=tuple(objects), lights=_lights(scene, edits, on), animation=animation)
    _know_origin(made, scene, edits)
    return Edited(scene, edits, made, np.concatenate([*triangles, *quadrics]), lights)


def _lights(scene: Scene, edits: Edits, on: set[int]) -> tuple[Light, ...]:
    """The lights that are on, where they are; one that was moved stays there."""
    places = dict(edits.moved_lights)
    found: list[Light] = []
    for n in sorted(on):
        light = scene.lights[n]
        if n in places:
            light = replace(light, position=places[n], track=None)
        found.append(light if n == len(found) else replace(light, number=n))
    return tuple(found)


_origins: dict[int, tuple[weakref.ref[Scene], weakref.ref[Scene], Edits]] = {}  # of edited scenes that are in use


def _know_origin(made: Scene, scene: Scene, edits: Edits) -> None:
    key = id(made)
    _origins[key] = weakref.ref(made, lambda _: _origins.pop(key, None)), weakref.ref(scene), edits


class Origin:
    """What a scene was made of, without holding on to it: of what was read, and of edits, none if it is that scene
    itself.  The same file, read once more, and the same edits make a scene of the same origin."""

    def __init__(self, scene: Scene) -> None:
        made, original, edits = _origins.get(id(scene), (None, None, NO_EDITS))
        known = made is not None and made() is scene
        read = original() if known and original is not None else None
        self._code, self._edits = code_of(read or scene), edits if known else NO_EDITS

    def is_of(self, scene: Scene | None) -> bool:
        """Whether a scene is made of the same."""
        return scene is not None and vars(Origin(scene)) == vars(self)


# --- objects -----------------------------------------------------------------------------------------


def _objects(scene: Scene, edits: Edits) -> tuple[list[SceneObject], list[Held]]:
    """The objects of the edited scene, and which primitives each holds."""
    static, static_held = scene.objects[0], held_by(scene, 0)
    never = [thing for thing in things(scene) if thing.index == 0]
    part_of = static.part_of
    if part_of is None:
        part_of = np.full(len(static.triangles) + len(static.quadrics), -1, np.int32)
    there = ~np.isin(np.concatenate(static_held), list(edits.hidden_primitives))
    there &= ~np.isin(part_of, [thing.part for thing in never if thing.name in edits.hidden])
    moves = [thing for thing in never if thing.name in edits.moving - edits.hidden]
    freed: list[tuple[SceneObject, Held]] = []
    for thing in moves:
        mine = there & (part_of == thing.part)
        one = replace(subset(static, mine), name=thing.name, chain=(np.eye(4),), parts=(), part_of=None)
        freed.append((one, _of(static_held, mine)))
    shown = there & ~np.isin(part_of, [thing.part for thing in moves])
    if not shown.all():
        static, static_held = subset(static, shown), _of(static_held, shown)

    dynamic: list[tuple[SceneObject, Held]] = []
    names = {thing.index: thing.name for thing in things(scene)}
    times = dict(edits.static)
    for index, one in enumerate(scene.objects[1:], 1):
        held, name = held_by(scene, index), names.get(index, "")
        kept = ~np.isin(np.concatenate(held), list(edits.hidden_primitives))
        if not kept.all():
            one, held = subset(one, kept), _of(held, kept)
        if name in times:
            if name not in edits.hidden and scene.animation.visible(one.chain, times[name]):
                static = joined(static, _at_rest(scene, one, times[name]), name)
                static_held = np.append(static_held[0], held[0]), np.append(static_held[1], held[1])
            continue
        dynamic.append((replace(one, chain=(NEVER, *one.chain)) if name in edits.hidden else one, held))
    every = [(static, static_held), *dynamic, *freed]
    return [one for one, _ in every], [held for _, held in every]


def _of(held: Held, kept: NDArray[np.bool_]) -> Held:
    return held[0][kept[: len(held[0])]], held[1][kept[len(held[0]) :]]


def subset(one: SceneObject, kept: NDArray[np.bool_]) -> SceneObject:
    """An object with some of its primitives: kept (triangles, then quadrics) bool."""
    t, q = kept[: len(one.triangles)], kept[len(one.triangles) :]
    triangles = Triangles(*(getattr(one.triangles, name)[t] for name in _TRIANGLES))
    deformation = one.deformation
    if deformation is not None:
        parts = {name: getattr(deformation, name)[t] for name in ("times", "corners", "normals")}
        deformation = replace(deformation, **parts)
    return replace(
        one,
        triangles=triangles,
        quadrics=Quadrics(*(getattr(one.quadrics, name)[q] for name in _QUADRICS)),
        deformation=deformation,
        part_of=None if one.part_of is None else one.part_of[kept],
    )


def _at_rest(scene: Scene, one: SceneObject, time: float) -> SceneObject:
    """An object in world space, as it is at a time."""
    matrix, triangles = scene.animation.matrix(one.chain, time), one.triangles
    if one.deformation is not None:
        corners, normals = deformed(one.deformation, time)
        triangles = replace(triangles, corners=corners, normals=normals)
    wide, normals_there = (array.astype(np.float64) for array in (triangles.corners, triangles.normals))
    there, turned = under_matrix(wide, normals_there, matrix)
    uvs = triangles.uvs[:, [0, 2, 1]] if np.linalg.det(matrix[:3, :3]) < 0 else triangles.uvs
    triangles = replace(triangles, corners=there.astype(np.float32), normals=unit_normals(turned, there), uvs=uvs)
    square = np.concatenate([one.quadrics.to_object, np.tile([[[0.0, 0.0, 0.0, 1.0]]], (len(one.quadrics), 1, 1))], 1)
    to_world: Float64 = (matrix @ square)[:, :3]
    return SceneObject(one.name, triangles, replace(one.quadrics, to_object=to_world))


def joined(static: SceneObject, one: SceneObject, name: str) -> SceneObject:
    """What never moves, with an object that does not move either as a further part of it."""
    parts, part_of, n = static.parts, static.part_of, len(static.triangles)
    if part_of is None:
        parts, part_of = (static.name,), np.zeros(n + len(static.quadrics), np.int32)
    new = np.full(len(one.triangles) + len(one.quadrics), len(parts), np.int32)
    split = [part_of[:n], new[: len(one.triangles)], part_of[n:], new[len(one.triangles) :]]
    return replace(
        static,
        triangles=_rows(Triangles, _TRIANGLES, static.triangles, one.triangles),
        quadrics=_rows(Quadrics, _QUADRICS, static.quadrics, one.quadrics),
        parts=(*parts, name),
        part_of=np.concatenate(split),
    )


def _rows(kind, names, one, other):
    return kind(*(np.concatenate([getattr(one, name), getattr(other, name)]) for name in names))


_TRIANGLES = ("corners", "normals", "uvs", "material", "texture")
_QUADRICS = ("kind", "to_object", "radii", "inside", "material")
