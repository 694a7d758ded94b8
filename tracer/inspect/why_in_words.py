"""The reasons of `tracer.inspect.why` as sentences, whose links lead to what is named."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.inspect.occluded_by import OccludedBy, Pixel, Reference
from tracer.inspect.reasons import MEANING, WHY_TRACED, Coverage, Reason, Rule, TaughtBy, Why
from tracer.method import Method, title_of
from tracer.scene.model import CONE, Scene

MOST_NAMED = 3  # primitives of an answer that are named
_MOVING = "objects that move"  # where a verdict's meaning says that they are asked
_CLAUSES = {
    Rule.FULL_SHADOW: "fully rendered, and every shadow ray so far was blocked ",
    Rule.NON_SHADOW: "nothing static has ever blocked it ",
    Rule.DYNAMIC: "dynamic, never culled ",
    Rule.NO_SHADOW_MODE: "fully rendered, but none of its shadow rays has asked this light before ",
}
"""Before the section of each rule."""
_ALTHOUGH = {
    ShadowMode.FULL_SHADOW: " although it has been dark so far",
    ShadowMode.NON_SHADOW: " although nothing static has blocked it so far",
}
"""Of a shadow mode that is not trusted."""


@dataclass(frozen=True)
class Link:
    """Words that stand for something: a primitive, a pixel, a frame that taught, or a section of the paper."""

    text: str
    primitive: int | None = None
    pixel: Pixel | None = None
    frame: int | None = None
    section: str = ""


Sentence = tuple[str | Link, ...]
"""Words and links, in order; spaces are in the words."""


def plain(sentence: Iterable[str | Link]) -> str:
    """Return a sentence as text."""
    return "".join(part if isinstance(part, str) else part.text for part in sentence)


def kind_of(scene: Scene, primitive: int) -> str:
    """Return what a primitive is: triangle, sphere or cone."""
    if primitive < scene.triangle_count:
        return "triangle"
    index = scene.object_of(primitive)
    kind = scene.objects[index].quadrics.kind[primitive - scene.quadric_offsets[index]]
    return "cone" if kind == CONE else "sphere"


def named(scene: Scene, primitive: int) -> str:
    """Return a primitive by its object, its kind and its number."""
    if not 0 <= primitive < scene.primitive_count:
        return f"primitive {primitive}"
    return f"{scene.name_of(primitive)} ({kind_of(scene, primitive)} {primitive})"


def primitive_in_words(scene: Scene, primitive: int) -> str:
    """Return a primitive as people find it again: its kind and number, its object and its material."""
    if not 0 <= primitive < scene.primitive_count:
        return f"primitive {primitive}"
    material = scene.material_of(primitive).name
    return f"{kind_of(scene, primitive)} {primitive} of {scene.name_of(primitive)} ({material})"


class Words:
    """Writes the sentences about a pixel of a scene."""

    def __init__(self, scene: Scene, found: Why) -> None:
        self._scene, self._found = scene, found

    def reason(self, reason: Reason) -> Sentence:
        """Say in one sentence why the shadow rays to a light were culled or traced."""
        said = [*self._rule(reason)]
        if reason.rays < reason.samples and reason.rule is not Rule.FACES_AWAY:
            said.append(f" So are {reason.rays} of its {reason.samples} samples.")
        if reason.more:
            said.append(f" {reason.more}")
        return tuple(said)

    def answer(self, reason: Reason) -> Sentence:
        """Say whether the light gets there, what is in its way, and whether the frame's answer is wrong."""
        if reason.fate is Fate.FACES_AWAY:
            return ()
        blocked = reason.lit < reason.rays
        if reason.wrong and reason.samples > 1:
            return (f"{reason.wrong} of the answers for its {reason.samples} samples are wrong.",)
        if reason.wrong:
            truth = (
                (self.primitive(reason.blocker), " is in its way")
                if reason.blocker >= 0
                else ("nothing is in its way",)
            )
            return (f"{'In shadow' if blocked else 'Lit'} in the picture, which is wrong: ", *truth, ".")
        if not blocked:
            return ("Lit.",)
        if reason.lit:
            return (f"In the penumbra: {reason.lit} of {reason.rays} samples reach it.",)
        if reason.blocker < 0:
            return ("In shadow.",)
        if reason.blocker == self._found.primitive:
            return ("In shadow: its own surface is in the way, as the light grazes it.",)
        return ("In shadow: blocked by ", self.primitive(reason.blocker), ".")

    def coverage(self, unit: Coverage, told: bool = False) -> Sentence:
        """Say what keeps a unit from being fully rendered, or how far it is from being examined anew; `told` if what
        hides it has just been said."""
        covers = f"{'Its cell covers' if unit.in_cells else 'Covers'} {_pixels(unit.pixels)}"
        if unit.after is OcclusionMode.DYNAMIC:
            return (f"{covers}. Dynamic: it has no modes ", *_section("2.2"), ".")
        if unit.after is OcclusionMode.PARTIALLY_OCCLUDED:
            if unit.occluded is not None and told:
                return (
                    f"{covers}; not fully rendered, as it is partially occluded (see above) ",
                    *_section("2.6"),
                    ".",
                )
            return (covers, ". Not fully rendered: ", *self._occluded(unit.occluded), ".")
        if unit.after is OcclusionMode.INIT and unit.before is OcclusionMode.FULLY_RENDERED:
            return (
                f"{covers}, more than {unit.zoom_factor:g} times as many as when it was last examined: it is examined "
                "anew ", *_section("2.6"), ".",
            )  # fmt: skip
        if unit.after is OcclusionMode.INIT:
            so_far = (
                f"{covers}, of which {unit.taught_pixels:,} have set its shadow modes so far. Fully rendered once all "
            )
            return (so_far, "have ", *_section("2.6"), ".")
        since: Sentence = (" since ", _frame(unit.taught)) if unit.taught is not None else ()
        if unit.before is not OcclusionMode.FULLY_RENDERED:
            return (covers, ". Fully rendered from this frame on: nothing hides any of it ", *_section("2.6"), ".")
        times = f"{unit.pixels / max(unit.highest, 1):.2g} × the {unit.highest:,} when it was last examined"
        return (
            f"{covers}, {times}; examined anew above {unit.zoom_factor:g} × ", *_section("2.6"), ". Fully rendered",
            *since, ".",
        )  # fmt: skip

    def reference(self, one: Reference) -> Sentence:
        """Say what became of the occlusion test against a reference pixel (Figure 3)."""
        said: Sentence = ("The ", Link(self._beside(one.pixel) or "reference pixel", pixel=one.pixel))
        if one.primitive < 0:
            return (*said, " sees nothing: no test.")
        if not one.tested:
            return (*said, " sees the same: no test.")
        met = "is met: it goes on behind this pixel" if one.occluded else "is not met"
        return (*said, " sees ", self.primitive(one.primitive), f", which {met}.")

    # --- parts of sentences ----------------------------------------------------------------------

    def primitive(self, number: int) -> Link:
        """Name a primitive."""
        return Link(named(self._scene, number), primitive=number)

    def _beside(self, pixel: Pixel) -> str:
        return {
            (-1, 0): "pixel on its left",
            (1, 0): "pixel on its right",
            (0, -1): "pixel above it",
            (0, 1): "pixel below it",
        }.get((pixel[0] - self._found.x, pixel[1] - self._found.y), "")

    def _at(self, pixel: Pixel) -> Sentence:
        beside = self._beside(pixel)
        if pixel == (self._found.x, self._found.y):
            return (" at ", Link("this pixel", pixel=pixel))
        return (" at ", Link(f"the {beside}" if beside else f"pixel ({pixel[0]}, {pixel[1]})", pixel=pixel))

    def _occluded(self, by: OccludedBy | None) -> Sentence:
        """What hides it, and where."""
        if by is None:
            return ("partially occluded ", *_section("2.3"))
        at, section = self._at(by.pixel), _section("2.3")
        if by.at_edge:
            return ("clipped by the screen's edge", *at, " ", *section)
        if by.primitive < 0:
            return ("its outline goes on", *at, ", which sees nothing: that is rounding ", *section)
        return ("partially occluded by ", self.primitive(by.primitive), *at, " ", *section)

    def _rule(self, reason: Reason) -> Sentence:
        """The sentence of a rule."""
        match reason.rule:
            case Rule.FACES_AWAY:
                return ("Faces away from this light.",)
            case Rule.FULL_SHADOW:
                return ("Culled: ", *self._clause(reason), ".")
            case Rule.NON_SHADOW:
                movers = _movers(reason.dynamic_objects)
                asks = f"Asks {movers} only: " if reason.dynamic_objects else "Asks nothing, as nothing moves: "
                return (asks, *self._clause(reason), ".")
            case Rule.KNOWN:
                return self._known(reason)
            case Rule.CLUSTERS:
                return ("Shaded by clusters of lights: no light is asked by itself.",)
            case Rule.NOT_ANSWERED:
                return (f"Traced: {title_of(reason.method)} knows nothing of lamps of several samples.",)
            case Rule.UNKNOWN:
                return (_unknown(reason),)
            case Rule.OFF:
                return self._off(reason)
            case Rule.NOT_SHADED:
                return self._not_shaded(reason)
            case Rule.PARTLY_OCCLUDED | Rule.NOT_SEEN_WHOLE | Rule.EXAMINED_ANEW:
                return (f"Traced{_ALTHOUGH.get(reason.shadow, '')}: ", *self._clause(reason), ".")
        return ("Traced: ", *self._clause(reason), ".")

    def _clause(self, reason: Reason) -> Sentence:
        """What modes say by a rule of the paper, or why they say nothing."""
        rule = reason.rule
        match rule:
            case Rule.PARTLY_OCCLUDED:
                return self._partly()
            case Rule.NOT_SEEN_WHOLE | Rule.EXAMINED_ANEW:
                return self._not_whole(rule)
            case Rule.PARTIAL_SHADOW:
                return _partial(reason)
            case Rule.NO_ROOM:
                return _no_room(reason)
        return (_CLAUSES[rule], *_section(rule.section))

    def _partly(self) -> Sentence:
        unit, trusted = self._found.coverage, (", so its shadow mode is not trusted ", *_section("2.4"))
        if unit is not None and unit.occluded is not None:
            return (*self._occluded(unit.occluded), *trusted)
        found_no_more = "; this frame finds it so no more"
        return ("partially occluded in the frame before ", *_section("2.3"), *trusted, found_no_more)

    def _not_whole(self, rule: Rule) -> Sentence:
        unit, section = self._found.coverage, _section("2.6")
        anew = "examined anew, and not seen whole again" if rule is Rule.EXAMINED_ANEW else "not seen whole"
        said: Sentence = (f"{anew} before this frame ", *section)
        if unit is not None and unit.occluded is not None:
            return (*said, ", and now ", *self._occluded(unit.occluded))
        if unit is not None and unit.after is OcclusionMode.FULLY_RENDERED:
            return (*said, ", which sees it so: its shadow mode counts from the next one on ", *_section("2.4"))
        if unit is not None and unit.after is OcclusionMode.INIT:
            return ("seen whole, but too few of its pixels have set its shadow modes so far ", *section)
        return said

    def _known(self, reason: Reason) -> Sentence:
        assert reason.verdict is not None
        meaning = MEANING[reason.verdict]
        culled = reason.fate is Fate.CULLED
        said: list[str | Link] = [f"Culled: {meaning[0].lower()}{meaning[1:]}" if culled else meaning]
        if reason.fate is Fate.DYNAMIC_ONLY and reason.dynamic_objects and _MOVING not in meaning:
            said.append(f" It asks {_movers(reason.dynamic_objects)} only.")
        if reason.told:
            said.append(f" {reason.told}")
        if reason.named:
            said.append(" It names ")
            for number, primitive in enumerate(reason.named[:MOST_NAMED]):
                said += [", "] * (number > 0) + [self.primitive(primitive)]
            more = len(reason.named) - MOST_NAMED
            said.append(f" and {more} more." if more > 0 else ".")
        return tuple(said)

    def _off(self, reason: Reason) -> Sentence:
        if reason.instead is None:
            return ("Traced: culling is off.",)
        return ("Traced: culling is off. The paper's method would have ", *self._instead(reason.instead, " it: "), ".")

    def _not_shaded(self, reason: Reason) -> Sentence:
        if reason.instead is None:
            return ("This picture is shaded in part so far: what became of the ray is said of whole pictures.",)
        return (
            "Not shaded yet, but filled in from pixels nearby. A ray from here is ",
            *self._instead(reason.instead, ": "),
            ".",
        )

    def _instead(self, reason: Reason, then: str) -> Sentence:
        """What the paper's method makes of the modes, after "would have" or "is"."""
        if reason.rule is Rule.NON_SHADOW:
            then = f"{then.rstrip(': ')} against dynamic objects only: "
        does = {Rule.FULL_SHADOW: "culled", Rule.NON_SHADOW: "tested"}.get(reason.rule, "traced")
        return (f"{does}{then}", *self._clause(reason))


# --- clauses that name nothing of the scene ------------------------------------------------------


def _section(number: str) -> Sentence:
    return ("(", Link(f"§{number}", section=number), ")")


def _frame(taught: TaughtBy) -> Link:
    return Link(taught.name, frame=taught.frame)


def _pixels(number: int) -> str:
    return f"{number:,} {'pixel' if number == 1 else 'pixels'}"


def _movers(number: int) -> str:
    return "the dynamic object" if number == 1 else f"the {number:,} dynamic objects"


def _partial(reason: Reason) -> Sentence:
    section = _section("2.5")
    if not reason.taught:
        return ("PARTIAL_SHADOW, as some of its shadow rays were blocked and others were not ", *section)
    newest = max(one.frame for one in reason.taught)
    last = [one for one in reason.taught if one.frame == newest][-1]
    did = "saw the light" if last.lit else "was in shadow"
    return ("PARTIAL_SHADOW since ", _frame(last), f", in which some of it {did} ", *section)


def _no_room(reason: Reason) -> Sentence:
    if Method.parse(reason.method).uses_modes or not Method.parse(reason.method).culls:
        return (f"modes have room for {reason.limit} lights, and this one is past them ", *_section("2.2"))
    return (f"{title_of(reason.method)} answers rays to the first {reason.limit} lights only",)


def _unknown(reason: Reason) -> str:
    if reason.told:
        return WHY_TRACED.get(reason.told, f"Traced. {reason.told}")
    return f"Traced: {title_of(reason.method)} knows nothing of this light here."
