"""Tables of a scene's objects and of its primitives, with what the newest frame found out about them.

A table is a column of numbers, or of codes for words, for each thing that is told; never an object for a row, as there
may be millions."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.editing.edits import Edited
from tracer.frame import Frame
from viewer.state.palette import OCCLUSION, SHADOW
from viewer.state.parts import KINDS, parts_of
from viewer.state.views import has_modes_of_cells
from viewer.util.numbers import count

UNKNOWN, SEVERAL = -1, 4  # beside the four modes
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


_AT_PIXELS = "at the pixels that show it, of all bounces"
_DUE = Column("due", "Due", f"shadow rays that are due {_AT_PIXELS}")
_SAVED = Column("saved", "Untraced", f"shadow rays {_AT_PIXELS} that were not traced through the whole scene")
_SHARE = Column("share", "Share", "share of the due shadow rays that is untraced, in per cent")
_WRONG = Column("wrong", "Wrong", "wrong shadow answers at its pixels, in all samples; known while frames are verified")
_PIXELS = Column("pixels", "Pixels", "pixels that it covers now")
COLUMNS: dict[Level, tuple[Column, ...]] = {
    Level.PRIMITIVES: (
        Column("number", "Number", "the primitive's number in the scene"),
        Column("object", "Object", "the object, or the part of the static geometry, that it belongs to", False),
        _PIXELS,
        Column("occlusion", "Occlusion", "its occlusion mode; of cells, that of all visible cells", False),
        Column("shadow", "Shadow", "its shadow mode for the chosen light; of cells, that of all visible cells", False),
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
        Column("full_shadow", "In shadow", "number of its primitives with full shadow for the chosen light"),
        Column("non_shadow", "Lit", "number of its primitives with non-shadow for the chosen light"),
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
    def keys(self) -> NDArray[np.float64]:
        """What the column is sorted by: words by the alphabet; NaN, which comes last, where nothing is known."""
        if self.words is None:
            return self.numbers.astype(np.float64)
        folded = [word.casefold() for word in self.words]
        ranks = np.full(len(folded) + 1, np.nan)  # -1 finds the last of them
        ranks[sorted(range(len(folded)), key=folded.__getitem__)] = np.arange(len(folded))
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


_OCCLUSION, _SHADOW = ((*(one.name for one in modes.values()), "several") for modes in (OCCLUSION, SHADOW))


def tables_of(now: Edited, frame: Frame, light: int) -> dict[Level, Table]:
    """Both tables as a frame of the edited scene knows them, with shadow modes for a light.

    Their rows are the parts and primitives of the scene as it was read, in its order."""
    scene, edits, parts, total = now.original, now.edits, parts_of(now.original), now.original.primitive_count
    counts = _counts(now, frame)
    occlusion, shadow = _modes_of(now, frame, light)
    resting = dict(edits.static)
    moving = np.array(
        [name in edits.moving or (moves and name not in resting) for name, moves in zip(parts.names, parts.moving)],
        np.int8,
    )
    hidden = np.array([name in edits.hidden for name in parts.names], np.int8)
    hidden_too = hidden[parts.part_of]
    hidden_too[list(edits.hidden_primitives)] = 1

    def states(motion: NDArray, hidden: NDArray) -> dict[str, Values | None]:
        return {"motion": Values(motion, ("static", "dynamic")), "hidden": Values(hidden, ("shown", "hidden"))}

    def having(codes: NDArray | None, mode: int) -> Values | None:
        """How many primitives of each part have a mode."""
        return None if codes is None else Values(np.bincount(parts.part_of[codes == mode], minlength=len(hidden)))

    primitives = {
        "number": Values(np.arange(total, dtype=np.int32)),
        "object": Values(parts.part_of, parts.names),
        "kind": Values(parts.kind, KINDS),
        "material": Values(parts.material, tuple(material.name for material in scene.materials)),
        "texture": Values(parts.texture, tuple(texture.name for texture in scene.textures)),
        "occlusion": None if occlusion is None else Values(occlusion, _OCCLUSION),
        "shadow": None if shadow is None else Values(shadow, _SHADOW),
        **states(moving[parts.part_of], hidden_too), **_counted(counts),
    }  # fmt: skip
    sums = {name: np.bincount(parts.part_of, one, len(hidden)).astype(np.int64) for name, one in counts.items()}
    objects = {
        "object": Values(np.arange(len(hidden), dtype=np.int32), parts.names),
        "primitives": Values(parts.sizes),
        "seen": having(counts["pixels"] > 0, True),
        "rendered": having(occlusion, OcclusionMode.FULLY_RENDERED),
        "full_shadow": having(shadow, ShadowMode.FULL_SHADOW),
        "non_shadow": having(shadow, ShadowMode.NON_SHADOW),
        **states(moving, hidden), **_counted(sums),
    }  # fmt: skip
    found = (Level.PRIMITIVES, total, primitives), (Level.OBJECTS, len(hidden), objects)
    return {level: Table(level, rows, columns) for level, rows, columns in found}


def _counts(now: Edited, frame: Frame) -> dict[str, NDArray]:
    """(primitives,) each: pixels, and rays at these as far as the frame counts them."""
    shown, total = frame.primitive.reshape(-1), now.original.primitive_count
    hit = (shown >= 0) & (shown < len(now.primitives))
    at = now.primitives[shown[hit]]
    shaded = True if frame.shaded is None else frame.shaded  # the others have the nearest's rays
    counts = {"pixels": np.bincount(at, minlength=total).astype(np.int32)}
    for name, buffer in (("due", frame.due_rays), ("saved", frame.saved), ("wrong", frame.wrong)):
        if buffer is not None:
            rays = np.where(shaded, buffer, 0).reshape(-1)[hit]
            counts[name] = np.bincount(at, rays, minlength=total).astype(np.int64)
    return counts


def _counted(counts: dict[str, NDArray]) -> dict[str, Values | None]:
    """The columns of pixels and rays; None for what the frame does not count."""
    found: dict[str, Values | None] = dict.fromkeys(("due", "saved", "share", "wrong"))
    found.update((name, Values(numbers)) for name, numbers in counts.items())
    if "due" in counts and "saved" in counts:
        due, share = counts["due"], np.full(len(counts["due"]), np.nan, np.float32)
        np.divide(100.0 * counts["saved"], due, out=share, where=due > 0, casting="unsafe")
        found["share"] = Values(share)
    return found


def _modes_of(now: Edited, frame: Frame, light: int) -> tuple[NDArray | None, NDArray | None]:
    """(primitives,) int8 each: occlusion modes, and shadow modes for a light, of the scene as it was read; `SEVERAL`
    where visible cells differ, `UNKNOWN` where there are none.  None for what the frame has not."""
    in_cells, total = has_modes_of_cells(frame), len(now.primitives)
    if not frame.settings.keeps_modes or (len(frame.modes) < total and not in_cells):
        return None, None

    def as_read(codes: NDArray) -> NDArray[np.int8]:
        found = np.full(now.original.primitive_count, UNKNOWN, np.int8)
        found[now.primitives] = _of_cells(frame, total, codes) if in_cells else codes[:total]
        return found

    known = light < frame.lights and modes.has_shadow_mode(frame.modes, light)
    shadow = as_read(modes.shadow_mode(frame.modes, light)) if known else None
    return as_read(modes.occlusion_mode(frame.modes)), shadow


def _of_cells(frame: Frame, total: int, codes: NDArray) -> NDArray[np.int8]:
    """The mode of all cells of a primitive that the frame shows."""
    units, shown = frame.unit.reshape(-1), frame.primitive.reshape(-1)
    hit = (units >= 0) & (shown >= 0)
    has = np.zeros((4, total), np.bool_)
    has[codes[units[hit]], shown[hit]] = True
    found, different = np.argmax(has, axis=0).astype(np.int8), has.sum(axis=0)
    found[different == 0], found[different > 1] = UNKNOWN, SEVERAL
    return found
