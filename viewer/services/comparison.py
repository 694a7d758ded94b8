"""One frame by several methods, to be held side by side: traced, and drawn as a figure that says how it was made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tracer import fingerprint
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.version import program_version
from viewer.output import capture
from viewer.output.comparison import Comparison, Shown
from viewer.services import stills
from viewer.state import codec
from viewer.state.session import Session
from viewer.state.view_state import ViewState


def trace(
    scene: Scene,
    state: ViewState,
    comparison: Comparison,
    world: World,
    on_frame: Callable[[str, int, int], None] = lambda method, done, total: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> Shown:
    """Trace the frame of a state by each method, and by "none" as what is right, with modes of their own; the state's
    own method does not count.  Raises Cancelled.

    `on_frame` gets the method, and how many of its frames are done, of how many."""
    frames: dict[str, Frame] = {}
    for method in dict.fromkeys(("none", *comparison.methods)):
        settings = replace(state.settings, method=method)
        if Method.parse(method).has_certificates:
            settings = replace(settings, threads=1)  # which certificates are made depends on the turns of threads
        wanted = replace(state, settings=settings)
        renderer = Renderer(scene, wanted.settings, world=world)

        def tell(done: int, total: int, method: str = method) -> None:
            on_frame(method, done, total)

        if not (Method.parse(method).culls or settings.modes or wanted.draw.view.of_modes):  # it learns nothing
            wanted = wanted.with_warmup(frames=())
        frames[method] = stills.trace(renderer, wanted, on_frame=tell, cancelled=cancelled)
    reference = frames["none"]
    shown = {method: frames[method] for method in comparison.methods}
    warmed = len(state.warmup.frames) + len(stills.times_before(scene, state.time, state.warmup.of_path))
    return Shown(scene, state, comparison, shown, reference, warmed)


def save(shown: Shown, path: Path, text: str = "") -> None:
    """Draw the figure and write it with the text that it carries, its own by default; raises OSError in one line."""
    from viewer.output import comparison_figure  # loads matplotlib

    comparison_figure.save(shown, path, text or _text(shown))


def _text(shown: Shown) -> str:
    """What is compared, the counters of each method, and what they were made of."""
    state, scene = shown.state, shown.scene
    statistics = {method: frame.statistics.to_dict() for method, frame in shown.frames.items()}
    more = {
        "figure": codec.to_json(shown.comparison),
        "made": {"version": program_version(), "scene": fingerprint.of_scene(scene)},
    }
    number = Session(scene).frame_at(state.time)
    return capture.metadata(state, shown.reference.camera, number, state.size, statistics, more)
