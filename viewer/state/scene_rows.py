"""Tables of a scene's objects and of its primitives, with what the newest frame found out about them.

A table is a column of numbers, or of codes for words, for each thing that is told; never an object for a row, as there
may be millions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.scene.edits import Edited
from viewer.state.parts import KINDS, Parts, parts_of
from viewer.state.readings import has_modes_of_cells
from viewer.util.numbers import count

UNKNOWN, SEVERAL = -1, 4  # beside the four modes
SEVERAL_WORD = "several"
NOTHING = "-"  # in the place of what is not known


class Level(Enum):
    """What the rows of a table are."""

    OBJECTS = "Objects"
    PRIMITIVES = "Primitives"


@dataclass(frozen=True)
class Column:
    """A column's name, as filters write it too, its title, and what it tells."""

    name: str
    title: str
    tip: str
    numeric: bool = True


_LIGHT = "for the chosen light, or for all of them together"
_AT_PIXELS = "at the pixels that show it, of all bounces"
_DUE = Column("due", "Due", f"shadow rays that are due {_AT_PIXELS}")
_SAVED = Column("saved", "Untraced", f"shadow rays {_AT_PIXELS} that were not traced through the whole scene")
_SHARE = Column("share", "Share", "share of the due shadow rays that is untraced, in per cent")
_WRONG = Column("wrong", "Wrong", "wrong shadow answers at its pixels; known while frames are verified")
_PIXELS = Column("pixels", "Pixels", "pixels that it covers now")
COLUMNS: dict[Level, tuple[Column, ...]] = {
    Level.PRIMITIVES: (
        Column("number", "Number", "the primitive's number in the scene"),
        Column("object", "Object", "the object, or the part of the static geometry, that it belongs to", False),
        _PIXELS,
        Column("occlusion", "Occlusion", "its occlusion mode; of cells, that of all visible cells", False),
        Column("shadow", "Shadow", f"its shadow mode {_LIGHT}; of cells, that of all visible cells", False),
        _DUE, _SAVED, _SHARE, _WRONG,
        Column("kind", "Kind", "triangle, sphere or cone", False),
        Column("material", "Material", "its material", False),
        Column("texture", "Texture", "its texture", False),
    ),
    Level.OBJECTS: (
        Column("object", "Object", "its name in the scene", False),
        Column("primitives", "Primitives", "number of its primitives"),
        Column("seen", "Seen", "number of its primitives that are visible"),
        _PIXELS,
        Column("rendered", "Rendered", "number of its primitives that are fully rendered, so that rays can be culled"),
        Column("full_shadow", "In shadow", f"number of its primitives with full shadow {_LIGHT}"),
        Column("non_shadow", "Lit", f"number of its primitives with non-shadow {_LIGHT}"),
        _DUE, _SAVED, _SHARE, _WRONG,
        Column("motion", "Motion", "whether it is static or dynamic", False),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Values:
    """One column: numbers, NaN where there is none, or codes for `words`, -1 where there is none."""

    numbers: NDArray
    words: tuple[str, ...] | None = None

    def text(self, row: int) -> str:
        """As a cell shows it."""
        value = self.numbers[row]
        if self.words is not None:
            return self.words[value] if value >= 0 else NOTHING
        if self.numbers.dtype.kind == "f":
            return f"{value:.1f} %" if value == value else NOTHING
        return count(value)

    @cached_property
    def keys(self) -> NDArray:
        """What the column is sorted by: words by the alphabet, what is not known last."""
        if self.words is None:
            return self.numbers
        folded = [word.casefold() for word in self.words]
        ranks = np.full(len(folded) + 1, len(folded), np.int32)  # -1 finds the last of them
        ranks[sorted(range(len(folded)), key=folded.__getitem__)] = np.arange(len(folded), dtype=np.int32)
        return ranks[self.numbers]


@dataclass(frozen=True)
class Table:
    """`rows` rows with columns by name; what the frame does not know is None."""

    level: Level
    rows: int
    columns: dict[str, Values | None]

    def cell(self, name: str, row: int) -> str:
        """The text of a cell."""
        values = self.columns.get(name)
        return NOTHING if values is None else values.text(row)


def mode_words(kind: type[OcclusionMode] | type[ShadowMode]) -> tuple[str, ...]:
    """The modes in words, by their numbers, and what is said where there are several."""
    return (*(mode.name.replace("_", " ").lower() for mode in kind), SEVERAL_WORD)


_MOTION, _HIDDEN = ("static", "dynamic"), ("shown", "hidden")
_OCCLUSION, _SHADOW = mode_words(OcclusionMode), mode_words(ShadowMode)


class _Known(NamedTuple):
    """(primitives,) what a frame knows of each, None for what it does not record."""

    pixels: NDArray
    due: NDArray | None
    saved: NDArray | None
    wrong: NDArray | None
    occlusion: NDArray | None
    shadow: NDArray | None


def tables_of(now: Edited, frame: Frame, light: int | None) -> dict[Level, Table]:
    """Both tables as a frame of the edited scene knows them, with shadow modes for a light, or None for all.

    Their rows are the parts and primitives of the scene as it was read, in its order."""
    total, here = now.original.primitive_count, len(now.primitives)
    shown = frame.primitive.reshape(-1)
    hit = (shown >= 0) & (shown < here)
    at = now.primitives[shown[hit]]

    def summed(buffer: NDArray | None) -> NDArray | None:
        if buffer is None:
            return None
        rays = buffer if frame.shaded is None else np.where(frame.shaded, buffer, 0)  # the others have the nearest's
        return np.bincount(at, rays.reshape(-1)[hit], minlength=total).astype(np.int64)

    def by_original(codes: NDArray | None) -> NDArray | None:
        if codes is None or now.scene is now.original:
            return codes
        found = np.full(total, UNKNOWN, np.int8)
        found[now.primitives] = codes
        return found

    occlusion, shadow = (by_original(codes) for codes in modes_of(frame, here, light))
    pixels = np.bincount(at, minlength=total).astype(np.int32)
    work = summed(frame.due_rays), summed(frame.saved), summed(frame.wrong)
    known, parts = _Known(pixels, *work, occlusion, shadow), parts_of(now.original)
    return {Level.PRIMITIVES: _primitives(now, parts, known), Level.OBJECTS: _objects(now, parts, known)}


def moving_parts(now: Edited) -> NDArray[np.bool_]:
    """(parts,) which can move, as the scene is edited."""
    parts, resting = parts_of(now.original), dict(now.edits.static)
    moving, named = now.edits.moving, zip(parts.names, parts.moving.tolist(), strict=True)
    return np.array([name in moving or (moves and name not in resting) for name, moves in named], np.bool_)


def hidden_parts(now: Edited) -> NDArray[np.bool_]:
    """(parts,) which are hidden."""
    return np.array([name in now.edits.hidden for name in parts_of(now.original).names], np.bool_)


def _primitives(now: Edited, parts: Parts, known: _Known) -> Table:
    scene, hidden = now.original, hidden_parts(now)[parts.part_of]
    hidden[list(now.edits.hidden_primitives)] = True
    columns = {
        "number": Values(np.arange(len(known.pixels), dtype=np.int32)),
        "object": Values(parts.part_of, parts.names),
        "kind": Values(parts.kind, KINDS),
        "material": Values(parts.material, tuple(material.name for material in scene.materials)),
        "texture": Values(parts.texture, tuple(texture.name for texture in scene.textures)),
        "motion": Values(moving_parts(now)[parts.part_of].astype(np.int8), _MOTION),
        "hidden": Values(hidden.astype(np.int8), _HIDDEN),
        "pixels": Values(known.pixels),
        "occlusion": None if known.occlusion is None else Values(known.occlusion, _OCCLUSION),
        "shadow": None if known.shadow is None else Values(known.shadow, _SHADOW),
        **_work(known.due, known.saved, known.wrong),
    }
    return Table(Level.PRIMITIVES, len(known.pixels), columns)


def _objects(now: Edited, parts: Parts, known: _Known) -> Table:
    number = len(parts.names)

    def summed(values: NDArray | None) -> NDArray | None:
        return None if values is None else np.bincount(parts.part_of, values, minlength=number).astype(np.int64)

    def count_of(which: NDArray) -> Values:
        return Values(np.bincount(parts.part_of[which], minlength=number).astype(np.int32))

    def having(codes: NDArray | None, mode: int) -> Values | None:
        return None if codes is None else count_of(codes == mode)

    columns = {
        "object": Values(np.arange(number, dtype=np.int32), parts.names),
        "motion": Values(moving_parts(now).astype(np.int8), _MOTION),
        "hidden": Values(hidden_parts(now).astype(np.int8), _HIDDEN),
        "primitives": Values(parts.sizes),
        "seen": count_of(known.pixels > 0),
        "pixels": Values(np.bincount(parts.part_of, known.pixels, minlength=number).astype(np.int64)),
        "rendered": having(known.occlusion, OcclusionMode.FULLY_RENDERED),
        "full_shadow": having(known.shadow, ShadowMode.FULL_SHADOW),
        "non_shadow": having(known.shadow, ShadowMode.NON_SHADOW),
        **_work(summed(known.due), summed(known.saved), summed(known.wrong)),
    }
    return Table(Level.OBJECTS, number, columns)


def _work(due: NDArray | None, saved: NDArray | None, wrong: NDArray | None) -> dict[str, Values | None]:
    """The columns of rays."""
    share = None
    if due is not None and saved is not None:
        share = np.full(len(due), np.nan, np.float32)
        np.divide(100.0 * saved, due, out=share, where=due > 0, casting="unsafe")
    found = {"due": due, "saved": saved, "share": share, "wrong": wrong}
    return {name: None if values is None else Values(values) for name, values in found.items()}


def modes_of(frame: Frame, total: int, light: int | None) -> tuple[NDArray | None, NDArray | None]:
    """(total,) int8 each: occlusion modes and shadow modes of primitives, for a light or None for all, `SEVERAL` where
    they differ and `UNKNOWN` where there are none.  None for what the frame has not."""
    if not frame.settings.keeps_modes:
        return None, None
    asked = range(frame.lights) if light is None else (light,)
    lights = [one for one in asked if one < frame.lights and modes.has_shadow_mode(frame.modes, one)]
    occlusion = [modes.occlusion_mode(frame.modes)]
    shadow = [modes.shadow_mode(frame.modes, one) for one in lights]
    if has_modes_of_cells(frame):
        return _of_cells(frame, total, occlusion), _of_cells(frame, total, shadow) if lights else None
    if len(frame.modes) < total:
        return None, None
    return occlusion[0][:total].astype(np.int8), _together(shadow, total) if lights else None


def _together(planes: Sequence[NDArray], total: int) -> NDArray[np.int8]:
    """One mode of several for each primitive."""
    found = planes[0][:total].astype(np.int8)
    for plane in planes[1:]:
        found[found != plane[:total]] = SEVERAL
    return found


def _of_cells(frame: Frame, total: int, planes: Sequence[NDArray]) -> NDArray[np.int8]:
    """The mode of all cells of a primitive that the frame shows."""
    units, shown = frame.unit.reshape(-1), frame.primitive.reshape(-1)
    hit = (units >= 0) & (shown >= 0)
    units, shown = units[hit], shown[hit]
    has = np.zeros((4, total), np.bool_)
    for plane in planes:
        of_pixels = plane[units]
        for mode in range(4):
            has[mode, shown[of_pixels == mode]] = True
    found = np.argmax(has, axis=0).astype(np.int8)
    different = has.sum(axis=0)
    found[different == 0], found[different > 1] = UNKNOWN, SEVERAL
    return found
