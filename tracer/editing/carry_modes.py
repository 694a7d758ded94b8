"""What a renderer of an edited scene may take over from that of the scene before: modes that cannot have changed.

The paper's modes speak of static occluders and of lights (§2.2), and so an edit is what a change of the scene is to it:

- A light that is switched off takes its shadow modes along; those of the other lights stay.
- A light that is switched on has none yet, and every primitive must be seen whole anew.  So must it after a light has
  moved, whose modes are dropped (`ModeHistory.follow_lights`).
- Where static geometry has gone, the half of a mode is dropped that says that rays were blocked, of every primitive and
  light between which it may have been: FULL_SHADOW becomes INIT, PARTIAL_SHADOW becomes NON_SHADOW.  Where some has
  come, it is the other half (`tracer.culling.dependence`).  These primitives must be seen whole anew.
- What has become static has no modes yet, and what can move has none.  What is static elsewhere than before has gone
  and come, and has none yet either.
"""

from __future__ import annotations

import copy

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.dependence import drop_dependent
from tracer.culling.mode_history import ModeHistory
from tracer.culling.rest import nothing_rests
from tracer.editing.edits import Edited
from tracer.geometry.boxes import triangle_boxes
from tracer.geometry.primitives import Outlines
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.runtime.parallel import thread_count
from tracer.scene.lights import LampTable, Light, as_lamps
from tracer.scene.things import thing_numbers, things

NO_UNITS = np.empty(0, np.int32)


def carry_modes(before: Renderer, shown: Edited, after: Renderer, now: Edited) -> None:
    """Give the renderer of a scene the modes that hold there too, of the renderer that showed the scene before it.

    Both scenes are edits of one.  Modes of cells, and certificates, are not carried."""
    threads, outlines = thread_count(after.settings.threads), before.world.outlines()
    owners = thing_numbers(shown.original)
    moved = _moved(shown, now)[owners]
    gone, come = _changed_static(before.world, shown, after.world, now, moved, owners)
    for key, history in before.state.histories.items():
        if key[2] or history.light_positions is None:  # modes of cells, or of no frame yet
            continue
        kept = copy.copy(history)
        kept.words = history.words.copy()
        kept.follow_rest(nothing_rests(len(shown.scene.objects)), lambda: outlines, threads)
        for boxes, mode in ((gone, modes.FULL_SHADOW), (come, modes.NON_SHADOW)):
            drop_dependent(kept.words, outlines, history.light_positions, boxes, mode, threads)
        lights = as_lamps(shown.scene.lights, key[3], key[4])
        if len(gone) or len(come):  # what lies between a unit and a lamp of several samples is not looked into
            modes.forget_lights(kept.words, [n for n, light in enumerate(lights) if light.samples > 1])
        after.state.histories[key] = _renumbered(kept, lights, shown, after.world, now, moved, key[3:])


def _renumbered(
    kept: ModeHistory,
    lights: tuple[Light, ...],
    shown: Edited,
    world: World,
    now: Edited,
    moved: NDArray[np.bool_],
    lamps: tuple[float | None, int | None],
) -> ModeHistory:
    """A history with the numbers that primitives and lights have now."""
    assert kept.light_positions is not None
    made = ModeHistory(world.object_of, len(now.lights), 1, NO_UNITS)
    old = shown.numbers[now.primitives]
    there = np.flatnonzero((old >= 0) & ~moved[now.primitives])
    made.pixel_count[there], made.highest_count[there] = kept.pixel_count[old[there]], kept.highest_count[old[there]]
    words = kept.words[old[there]].astype(np.uint64)
    occlusion = modes.occlusion_mode(words)
    static = (occlusion != modes.DYNAMIC) & (world.object_of[there] == 0)
    found = words & np.uint64(3)
    positions = np.full((len(now.lights), 3), np.nan)
    shapes = list(as_lamps(now.scene.lights, *lamps))
    for light, number in enumerate(now.lights.tolist()):
        before = shown.light_here(number)
        if before >= 0:
            positions[light], shapes[light] = kept.light_positions[before], lights[before]
        if not modes.has_shadow_mode(made.words, light):
            continue
        if not modes.has_shadow_mode(kept.words, before):  # it was off, or one of too many
            found[occlusion == modes.FULLY_RENDERED] &= ~np.uint64(3)
        else:
            found |= modes.shadow_mode(words, before).astype(np.uint64) << np.uint64(2 + 2 * light)
    made.words[there[static]] = found[static].astype(made.words.dtype)
    if shapes:
        made.follow_lights(positions, LampTable(tuple(shapes)))
    return made


def _moved(shown: Edited, now: Edited) -> NDArray[np.bool_]:
    """(things of the original,) bool: which are static at another time than before."""
    then, times = dict(shown.edits.static), dict(now.edits.static)
    names = [thing.name for thing in things(shown.original)]
    elsewhere = [name in times and times[name] != then.get(name, times[name]) for name in names]
    return np.array(elsewhere, np.bool_)


def _changed_static(
    before: World, shown: Edited, after: World, now: Edited, moved: NDArray[np.bool_], owners: NDArray[np.int32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Boxes (k, 6) around static things, as far as these have gone; and around those that have come."""
    count = shown.original.primitive_count
    was, is_now = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    was[shown.primitives[before.object_of == 0]] = True
    is_now[now.primitives[after.object_of == 0]] = True
    gone = _boxes(before.outlines(), shown.numbers, np.flatnonzero(was & (moved | ~is_now)), owners)
    return gone, _boxes(after.outlines(), now.numbers, np.flatnonzero(is_now & (moved | ~was)), owners)


def _boxes(
    outlines: Outlines, numbers: NDArray[np.int32], which: NDArray[np.intp], owners: NDArray[np.int32]
) -> NDArray[np.float32]:
    """Boxes (k, 6) around those primitives of each thing, of static geometry, that have these numbers originally."""
    here, made = numbers[which], np.empty((len(which), 6), np.float32)
    triangle = here < len(outlines.triangles)
    made[triangle] = triangle_boxes(outlines.triangles[here[triangle]])
    made[~triangle] = outlines.boxes[here[~triangle] - len(outlines.triangles)]
    mine = owners[which]
    each = [made[mine == owner] for owner in np.unique(mine)]
    around = [np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)]) for boxes in each]
    return np.array(around, np.float32).reshape(-1, 6)
