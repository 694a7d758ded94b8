"""One frame by several methods, to be held side by side: what is asked for, how it is traced, and kept as JSON."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from tracer import fingerprint
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.version import program_version
from viewer.output import capture
from viewer.output.comparison_figure import EDITION, Crop, Shown
from viewer.services import stills
from viewer.state import codec
from viewer.state.session import Session
from viewer.state.view_state import ViewState

MOST_METHODS, MOST_CROPS = 6, 6


@dataclass(frozen=True)
class Comparison:
    """`recipe` is what all methods have in common; its own method does not count.  `marks` are pixels (x, y) that are
    marked in the crops, and `words` stand below the title, which is of an `edition`."""

    recipe: ViewState
    methods: tuple[str, ...]
    crops: tuple[Crop, ...]
    marks: tuple[tuple[int, int], ...] = ()
    words: str = ""
    edition: int = EDITION

    def checked(self) -> Comparison:
        """The same; raises ValueError, in one line, for what cannot be drawn."""
        width, height = self.recipe.size
        if not 1 <= len(self.methods) <= MOST_METHODS or len(set(self.methods)) < len(self.methods):
            raise ValueError(f"--methods: give 1 to {MOST_METHODS}, each once")
        if len(self.crops) > MOST_CROPS:
            raise ValueError(f"--crops: {MOST_CROPS} at most, not {len(self.crops)}")
        for crop in self.crops:
            inside = crop.x + crop.width <= width and crop.y + crop.height <= height
            if not inside or crop.width < 1 or crop.height < 1:
                raise ValueError(f"--crops {crop}: not inside the picture of {width} x {height} pixels")
        for method in self.methods:
            Method.parse(method)
        return self

    def to_json(self) -> dict[str, Any]:
        """What a figure carries beside its state."""
        crops = [[c.x, c.y, c.width, c.height] for c in self.crops]
        more: dict[str, Any] = {"marks": [list(mark) for mark in self.marks]} if self.marks else {}
        more |= {"words": self.words} if self.words else {}
        more |= {"edition": self.edition} if self.edition > 1 else {}
        return {"methods": list(self.methods), "crops": crops} | more


def from_json(state: ViewState, data: Any) -> Comparison:
    """Return the inverse of `to_json`; raises ValueError in one line."""
    common = state
    kept = codec.from_json(data, _Kept, "its figure")
    crops = tuple(Crop(*sides) for sides in kept.crops)
    return Comparison(common, kept.methods, crops, kept.marks, kept.words, kept.edition).checked()


@dataclass(frozen=True)
class _Kept:
    """What a figure carries beside its state."""

    methods: tuple[str, ...]
    crops: tuple[tuple[int, int, int, int], ...]
    marks: tuple[tuple[int, int], ...] = ()
    words: str = ""
    edition: int = 1


def trace(
    scene: Scene,
    comparison: Comparison,
    world: World,
    on_frame: Callable[[str, int, int], None] = lambda method, done, total: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> Shown:
    """The frame by each method, and by "none" as what is right, with modes of their own; raises Cancelled.

    `on_frame` gets the method, and how many of its frames are done, of how many."""
    frames: dict[str, Frame] = {}
    for method in dict.fromkeys(("none", *comparison.methods)):
        settings = replace(comparison.recipe.settings, method=method)
        if Method.parse(method).has_certificates:
            settings = replace(settings, threads=1)  # which certificates are made depends on the turns of threads
        wanted = replace(comparison.recipe, settings=settings)
        renderer = Renderer(scene, wanted.settings, world=world)

        def tell(done: int, total: int, method: str = method) -> None:
            on_frame(method, done, total)

        if not (Method.parse(method).culls or settings.modes or wanted.draw.view.of_modes):  # it learns nothing
            wanted = wanted.with_warmup(frames=())
        frames[method] = stills.trace(renderer, wanted, on_frame=tell, cancelled=cancelled)
    reference = frames["none"]
    shown = {method: frames[method] for method in comparison.methods}
    common = comparison.recipe
    warmed = len(common.warmup.frames) + len(stills.times_before(scene, common.time, common.warmup.of_path))
    marked = comparison.marks, comparison.words, warmed, comparison.edition
    return Shown(scene, common, shown, reference, comparison.crops, *marked)


def text(shown: Shown, comparison: Comparison) -> str:
    """What a figure carries: what it compares, the counters of each method, and what they were made of."""
    common, scene = comparison.recipe, shown.scene
    statistics = {method: frame.statistics.to_dict() for method, frame in shown.frames.items()}
    more = {
        "figure": comparison.to_json(),
        "made": {"version": program_version(), "scene": fingerprint.of_scene(scene)},
    }
    number = Session(scene).frame_at(common.time)
    return capture.metadata(common, shown.reference.camera, number, common.size, statistics, more)
