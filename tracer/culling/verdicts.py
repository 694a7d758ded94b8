"""What became of a shadow ray: whether it was asked, what answered it, and how."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from tracer.culling.fate import Fate


class Verdict(Enum):
    """The names are those of the paper's modes and of certificates where there are any.

    `fate` is what becomes of a ray that is answered so, if dynamic objects need not be asked as well; `in_words` says
    that shortly, and `meaning` in a sentence."""

    fate: Fate
    in_words: str
    meaning: str

    def __new__(cls, value: str, fate: Fate, in_words: str, meaning: str) -> Verdict:
        made = object.__new__(cls)
        made._value_, made.fate, made.in_words, made.meaning = value, fate, in_words, meaning
        return made

    # fmt: off
    AWAY = ("away", Fate.FACES_AWAY, "surface faces away",
        "The light is behind the surface, so that no shadow ray is due.")
    PASSED_OVER = ("passed over", Fate.CULLED, "light hidden from the region",
        "The light is proven to be hidden from all that is near the point.")
    FULL_SHADOW = ("FULL_SHADOW", Fate.CULLED, "culled by FULL_SHADOW",
        "The primitive is fully rendered, and every shadow ray from it to this light was blocked.")
    NON_SHADOW = ("NON_SHADOW", Fate.CULLED, "dynamic only by NON_SHADOW",
        "The primitive is fully rendered, and nothing static blocked any shadow ray from it to this light: "
        "only objects that move are tested.")
    CERTIFIED_FULL = ("certificate full", Fate.CULLED, "culled by certificate full",
        "The whole cell is proven to be in the shadow of what does not move now.")
    CERTIFIED_LIT = ("certificate lit", Fate.CULLED, "dynamic only by certificate lit",
        "Nothing static is between the whole cell and the light: only objects that move are tested.")
    CANDIDATES = ("certificate candidates", Fate.CANDIDATES, "candidates only",
        "Only a few primitives can block the light here: these are tested, and objects that move.")
    BEAM = ("beam", Fate.CULLED, "culled by a beam",
        "What is between the lamp and neighbouring points was asked about all of its samples at once.")
    CACHED = ("cached occluder", Fate.CACHED, "cached occluder",
        "The primitive that blocked a ray there before was tested first, and blocks this one too.")
    BUFFER_LIT = ("light buffer lit", Fate.CULLED, "light buffer: nothing in front",
        "Nothing that the light sees in this direction is nearer to it than the point.")
    BUFFER_FULL = ("light buffer full", Fate.CULLED, "light buffer: behind what covers the cell",
        "The point is behind a triangle that hides all of a cell of the light's cube.")
    BUFFER_TESTED = ("light buffer candidates", Fate.CANDIDATES, "light buffer: candidates only",
        "Only a few primitives are in the point's cell of the light's cube: these are tested.")
    VOXEL_LIT = ("voxel null", Fate.CULLED, "lit voxel",
        "Nothing static is between the light and any point of the voxel: only objects that move are tested.")
    VOXEL_FULL = ("voxel full", Fate.CULLED, "full voxel",
        "One triangle hides the light from all of the voxel.")
    VOXEL_WALK = ("voxel walk", Fate.CANDIDATES, "walk through voxels",
        "Of the point's voxel nothing is known: the ray walked on towards the light, from voxel to voxel.")
    CELL_LIT = ("cell lit", Fate.CULLED, "lit cell",
        "The point's cell knows of nothing that blocks the light: only objects that move are tested.")
    CELL_FULL = ("cell full", Fate.CULLED, "light hidden from the cell",
        "The point's cell knows the light to be hidden from all of it.")
    CELL_TESTED = ("cell candidates", Fate.CANDIDATES, "blockers of the cell only",
        "The point's cell knows what may block the light: these primitives are tested, and objects that move.")
    ANSWERED = ("answered", Fate.CULLED, "culled",
        "The method knew the answer.")
    TRACED = ("traced", Fate.TRACED, "traced",
        "Nothing was known: the ray was traced through the scene.")
    # fmt: on

    @property
    def due(self) -> bool:
        """Whether the ray had to be answered."""
        return self.fate.is_due

    @property
    def culled(self) -> bool:
        """Whether it was answered without asking static geometry."""
        return self.due and not self.fate.is_traced


class Answered(NamedTuple):
    """A shadow ray that a method has answered: the primitive that it ends at, and the point (3,) above it; the light,
    and whether it says that the light gets there; and what the stage keeps for the point, a number."""

    primitive: int
    point: tuple[float, float, float]
    light: int
    lit: bool
    kept: int


class Because(NamedTuple):
    """Why it could be answered, the primitives that this rests on, and what more there is to say, in sentences."""

    verdict: Verdict
    named: tuple[int, ...] = ()
    told: str = ""
