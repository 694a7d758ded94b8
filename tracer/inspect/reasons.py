"""Why shadow rays are culled, or traced: the reasons that `why` finds, and what the words of them stand for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from tracer.culling.fate import Fate
from tracer.culling.modes import MAX_CULLED_LIGHTS, OcclusionMode, ShadowMode
from tracer.culling.verdicts import Verdict
from tracer.inspect.occluded_by import OccludedBy, Reference
from tracer.inspect.path_records import RayTree
from tracer.inspect.ray_tree import unused


class Rule(Enum):
    """What decides about a shadow ray, with the section of the paper that has it, if one does."""

    FACES_AWAY = ("faces away", "")
    FULL_SHADOW = ("FULL_SHADOW", "2.4")
    NON_SHADOW = ("NON_SHADOW", "2.4")
    KNOWN = ("another method knows", "")
    DYNAMIC = ("dynamic", "2.2")
    PARTLY_OCCLUDED = ("partially occluded", "2.3")
    NOT_SEEN_WHOLE = ("not seen whole", "2.6")
    EXAMINED_ANEW = ("examined anew", "2.6")
    PARTIAL_SHADOW = ("PARTIAL_SHADOW", "2.5")
    NO_SHADOW_MODE = ("no shadow mode", "2.5")
    NO_ROOM = ("no room for modes", "2.2")
    NOT_ANSWERED = ("the method leaves it", "")
    UNKNOWN = ("nothing is known", "")
    OFF = ("culling is off", "")
    CLUSTERS = ("clusters of lights", "")
    NOT_SHADED = ("not shaded yet", "")

    @property
    def section(self) -> str:
        """The section of the paper, "" for none."""
        return self.value[1]


SECTIONS = {
    "2.2": "Each primitive has an occlusion mode, and a shadow mode for each light. The occlusion mode of a "
    "dynamic object is DYNAMIC for good.",
    "2.3": "Occlusion testing: the ray of a pixel is tested against what its left and its upper neighbour see. What it "
    "meets there is hidden by something nearer, and so partially occluded; so is what the screen's edge cuts off.",
    "2.4": "Shadow testing: no ray of a fully rendered primitive in FULL_SHADOW is traced, those of one in NON_SHADOW "
    "are tested against dynamic objects only, and every other ray is traced.",
    "2.5": "Shadow-mode setting: a blocked ray adds FULL_SHADOW to the mode of its primitive and light, one that "
    "reaches the light NON_SHADOW. Both together are PARTIAL_SHADOW, which stays.",
    "2.6": "Occlusion-mode setting: what no test finds occluded is FULLY_RENDERED, until it covers so many times the "
    "pixels that it covered then. After that it is examined anew.",
}
"""What the paper's sections say."""

MEANING: dict[Verdict, str] = {
    Verdict.AWAY: "The light is behind the surface, so that no shadow ray is due.",
    Verdict.PASSED_OVER: "The light is proved to be hidden from all that is near the point.",
    Verdict.FULL_SHADOW: "The primitive is fully rendered, and every shadow ray from it to this light was blocked.",
    Verdict.NON_SHADOW: "The primitive is fully rendered, and nothing static blocked any shadow ray from it to this "
    "light: only objects that move are tested.",
    Verdict.CERTIFIED_FULL: "The whole cell is proved to be in the shadow of what does not move now.",
    Verdict.CERTIFIED_LIT: "Nothing static is between the whole cell and the light: only objects that move are tested.",
    Verdict.CANDIDATES: "Only a few primitives can block the light here: these are tested, and objects that move.",
    Verdict.BEAM: "What is between the lamp and neighbouring points was asked about all of its samples at once.",
    Verdict.CACHED: "The primitive that blocked a ray there before was tested first, and blocks this one too.",
    Verdict.BUFFER_LIT: "Nothing that the light sees in this direction is nearer to it than the point.",
    Verdict.BUFFER_FULL: "The point is behind a triangle that hides all of a cell of the light's cube.",
    Verdict.BUFFER_TESTED: "Only a few primitives are in the point's cell of the light's cube: these are tested.",
    Verdict.VOXEL_LIT: "Nothing static is between the light and any point of the voxel: only objects that move "
    "are tested.",
    Verdict.VOXEL_FULL: "One triangle hides the light from all of the voxel.",
    Verdict.VOXEL_WALK: "Of the point's voxel nothing is known: the ray walked on towards the light, from voxel to "
    "voxel.",
    Verdict.CELL_LIT: "The point's cell knows of nothing that blocks the light: only objects that move are tested.",
    Verdict.CELL_FULL: "The point's cell knows the light to be hidden from all of it.",
    Verdict.CELL_TESTED: "The point's cell knows what may block the light: these primitives are tested, and objects "
    "that move.",
    Verdict.ANSWERED: "The method knew the answer.",
    Verdict.TRACED: "Nothing was known: the ray was traced through the scene.",
}
"""What each verdict means."""

_PROVED = {
    "full": "the light is hidden from the whole cell",
    "lit": "nothing static is in the way",
    "candidates": "only a few primitives can block the light here",
}
WHY_NOT_CULLED: dict[Fate, str] = {
    Fate.PARTLY_OCCLUDED: "something hides a part of the primitive, or the screen's edge cuts it off (§2.3)",
    Fate.PARTIAL_SHADOW: "some shadow rays of the primitive were blocked and some were not (§2.5)",
    Fate.NOT_SEEN_WHOLE: "the primitive was not seen whole before, too few of its pixels have set its modes, none of "
    "its shadow rays has asked this light, or it is examined anew (§2.2, §2.6)",
    Fate.DYNAMIC: "the primitive belongs to a dynamic object, which is never culled (§2.2)",
}
"""Why the paper's method traces rays, by their fate, where nothing is said of a single pixel."""

_BY_MODE = {
    "INIT": Fate.NOT_SEEN_WHOLE,
    "PARTIALLY_OCCLUDED": Fate.PARTLY_OCCLUDED,
    "DYNAMIC": Fate.DYNAMIC,
    "PARTIAL_SHADOW": Fate.PARTIAL_SHADOW,
}

WHY_TRACED: dict[str, str] = {
    **{mode: f"Traced: {WHY_NOT_CULLED[fate]}." for mode, fate in _BY_MODE.items()},
    "candidates": "Traced: only a few primitives can block the light here, but to trace the ray with its neighbours is "
    "quicker than to test these.",
    **{
        unused(state): f"Traced: a certificate says that {known}. But Automatic looks no certificates up "
        "here, as it has measured that tracing every ray is quicker."
        for state, known in _PROVED.items()
    },
}
"""What tracing says where something was known all the same (`CullReason.known`)."""


@dataclass(frozen=True)
class TaughtBy:
    """The frame that gave a primitive its mode: its number, what it is called, and whether some of the primitive was
    lit in it or in shadow, None where the frame saw the primitive whole."""

    frame: int
    name: str
    lit: bool | None = None


@dataclass(frozen=True)
class Reason:
    """Why a pixel's shadow ray to one light was culled, or traced.

    Attributes
    ----------
    light : int
        Number of the light.
    rule : Rule
        What decided.
    fate : Fate
        What became of the ray.
    verdict : Verdict or None
        The same as `ray_tree` tells it; None where the pixel has not been shaded.
    rays, samples : int
        How many shadow rays this holds for, of how many to the light.
    lit : int
        How many of them reach the light.
    wrong : int
        How many answers for the light are not true.
    blocker : int
        The primitive that is truly in the way, -1 for none.
    shadow : ShadowMode
        The shadow mode by which the ray was decided about.
    named : tuple of int
        The primitives that the answer rests on.
    dynamic_objects : int
        How many dynamic objects there are to ask.
    limit : int
        To how many lights the method answers rays.
    told : str
        What more there is to say, in sentences.
    more : str
        How far the light may move before that is known no more, or whether more could be known.
    method : str
        The method.
    instead : Reason or None
        What the paper's method makes of the modes, where culling is off, or the pixel may not have been shaded yet.
    taught : tuple of TaughtBy
        Who set the shadow mode, where that is known.
    """

    light: int
    rule: Rule
    fate: Fate
    verdict: Verdict | None = None
    rays: int = 1
    samples: int = 1
    lit: int = 0
    wrong: int = 0
    blocker: int = -1
    shadow: ShadowMode = ShadowMode.INIT
    named: tuple[int, ...] = ()
    dynamic_objects: int = 0
    limit: int = MAX_CULLED_LIGHTS
    told: str = ""
    more: str = ""
    method: str = "paper"
    instead: Reason | None = None
    taught: tuple[TaughtBy, ...] = ()


@dataclass(frozen=True)
class Coverage:
    """How a pixel's unit, a primitive or a cell of one, stands in occlusion-mode setting (§2.6): its mode before the
    frame and after it, the pixels that it covers and those that it covered when it was examined last, how many times
    those it may cover, where it is partially occluded, how many pixels have set its modes where these are too few yet,
    and the frame that saw it whole."""

    before: OcclusionMode
    after: OcclusionMode
    pixels: int
    highest: int
    zoom_factor: float
    in_cells: bool
    occluded: OccludedBy | None = None
    taught_pixels: int = 0
    taught: TaughtBy | None = None


@dataclass(frozen=True)
class Why:
    """All that there is to say of a pixel: a reason for each light, how its unit stands, None where the frame keeps no
    modes, the two pixels that it is compared with, and its rays, None while they are not known."""

    x: int
    y: int
    primitive: int
    reasons: tuple[Reason, ...]
    coverage: Coverage | None = None
    references: tuple[Reference, ...] = ()
    tree: RayTree | None = None
