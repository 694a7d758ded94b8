"""Five short steps through the program: each says what to do, and ends when the user has done it.

A step watches: a generator that is resumed once per frame, and ends when the user has done it, in whatever order.  It
can be shown as well: a generator that does it, and yields how many seconds to wait before it goes on.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.experiments.zoom import Results
from tracer.explanation import Explanation
from tracer.frame import Frame
from tracer.method import Method
from viewer.services.controller import Controller
from viewer.state import navigation
from viewer.state.methods import BY_MODES, with_base
from viewer.state.views import View

SECONDS = 2.0  # that a picture stays when it is shown
PATIENCE = 20.0  # seconds that a picture or an answer may take to come
REST = 1.0  # seconds without anything going on, after which no other picture comes
_ZOOMED = 150.0  # pixels of what a shown zoom test goes to: few enough to become many, and many enough to be seen
_PLACES = sorted(  # where a shadow is looked for, in parts of the picture's width and height: from its middle on
    ((x / 14.0, y / 14.0) for x in range(1, 14) for y in range(1, 14)),
    key=lambda at: (at[0] - 0.5) ** 2 + (at[1] - 0.5) ** 2,
)


Key = Callable[[str], str]
"""The key of a command as the user reads it, by the command's name, or else where its menu is."""


@dataclass(frozen=True)
class Step:
    """`watch` ends when the step is done, `show` does it; `text` says what to do as things are, and `shown` what is to
    be seen while it is done for the user, where that is something else."""

    title: str
    text: Callable[[Controller, Key], str]
    watch: Callable[[Controller], Iterator[None]]
    show: Callable[[Controller, Callable[[str], None]], Iterator[float]]
    shown: str = ""


class Tour:
    """`at` is the number of the step that is next, or None while no tour is being taken; `done` are those done so far,
    the others are watched for.  `last_word` is what is said after the last step, until it is closed."""

    def __init__(self, controller: Controller, show_panel: Callable[[str], None], key: Key) -> None:
        self._c = controller
        self._show_panel, self._key = show_panel, key
        self.at: int | None = None
        self.last_word = ""
        self.done: set[int] = set()
        self._watches: list[Iterator[None]] = []
        self._script: Iterator[float] | None = None
        self._resumes_at = 0.0

    @property
    def step(self) -> Step | None:
        return STEPS[self.at] if self.at is not None else None

    def text(self, step: Step) -> str:
        """What to do in a step, as things are, with the keys that do it now, or what is being done."""
        if self.showing and step is self.step and step.shown:
            return step.shown
        return step.text(self._c, self._key)

    @property
    def showing(self) -> bool:
        """Whether the step is being done for the user."""
        return self._script is not None

    def start(self) -> None:
        self.done, self._watches = set(), [step.watch(self._c) for step in STEPS]
        self._c.selection.picked = None  # what was clicked before was not clicked for the tour
        self.last_word = ""
        self._go_to(0)

    def end(self) -> None:
        self.at = self._script = None
        self.last_word = ""

    def skip(self) -> None:
        """On to the next step that is not done; after the last the tour is over."""
        if self.at is not None:
            self._go_to(self.at + 1)

    def show(self) -> None:
        """Do the step for the user."""
        if self.step is not None:
            self._script, self._resumes_at = self.step.show(self._c, self._show_panel), 0.0

    def update(self) -> None:
        """Once per frame: see whether the step is done, and go on with what is being shown."""
        if self.at is None or self._c.frame is None:
            return
        if self._script is not None and time.monotonic() >= self._resumes_at:
            seconds = next(self._script, None)
            if seconds is None:
                self._script = None
            else:
                self._resumes_at = time.monotonic() + seconds
        self.done |= {n for n, watch in enumerate(self._watches) if next(watch, _DONE) is _DONE}
        if self.at in self.done and self._script is None:
            self.skip()
            self.last_word = "" if self.step is not None else _last_word(self._c, len(STEPS) - 1 in self.done)

    def _go_to(self, first: int) -> None:
        self._script = None
        self.at = next((n for n in range(first, len(STEPS)) if n not in self.done), None)


_DONE = object()


def _has_flown(c: Controller) -> Iterator[None]:
    scene, start = c.session.scene, c.session.camera
    while c.session.on_path or c.session.camera == start:
        if c.session.scene is not scene:  # another one was opened: nobody has flown there
            scene, start = c.session.scene, c.session.camera
        yield


def _fly(c: Controller, _: Callable[[str], None]) -> Iterator[float]:
    camera = c.session.camera
    c.motion.glide(navigation.fly(camera, 0.0, 0.0, 0.5 * c.motion.pace, c.motion.world_up))
    yield SECONDS


def _has_toggled_culling(c: Controller) -> Iterator[None]:
    """Off, and then seen again what culling saves."""
    for off in (True, False):
        shown = _shows(c, culling=not off)
        while Method.parse(c.session.settings.method).culls is off or not shown():
            yield


def _shows(c: Controller, culling: bool) -> Callable[[], bool]:
    """Whether the picture shows what culling saves, or that nothing is saved; where paper saves nothing, its picture
    has to rest, as its modes are set by a whole picture first."""
    rested_since = time.monotonic()

    def shows() -> bool:
        nonlocal rested_since
        method, now = c.session.settings.method, time.monotonic()
        if c.active or c.frame is None or c.frame.settings.method != method:
            rested_since = now
        if _culls(c) is culling:
            return True
        return culling and not Method.parse(method).adaptive and now > rested_since + REST

    return shows


def _until(met: Callable[[], bool]) -> Iterator[float]:
    """Wait until the picture has come that shows something, for as long as a user would."""
    end = time.monotonic() + PATIENCE
    yield 0.02  # what is there at first belongs to the picture, or the place, before
    while not met() and time.monotonic() < end:
        yield 0.02


def _culls(c: Controller) -> bool:
    """Whether culling has saved something in the newest frame."""
    return c.frame is not None and c.frame.statistics.shadow.traced < c.frame.statistics.shadow.due


def _toggle_culling(c: Controller, show_panel: Callable[[str], None]) -> Iterator[float]:
    before = c.session.settings.method
    show_panel("Statistics")
    if Method.parse(before).adaptive or not _culls(c):
        c.settings.change(method=with_base(before, BY_MODES))
        c.notices.say(f"the method is {c.session.settings.method} now, as {before} has culled nothing here")
    yield from _until(_shows(c, culling=True))
    yield SECONDS
    c.settings.toggle_culling()
    yield from _until(_shows(c, culling=False))
    yield SECONDS
    c.settings.toggle_culling()
    yield from _until(_shows(c, culling=True))
    yield SECONDS


def _how_to_toggle(c: Controller, key: Key) -> str:
    method, toggle = Method.parse(c.session.settings.method), key("Shadow culling")
    seen = "The picture looks the same, but without culling every shadow ray is traced: see the bar above the picture, "
    seen += "hatched while culling is off, and the row Traced in the Statistics panel."
    if method.adaptive:
        return (
            f"Choose {BY_MODES}, the published method, at the top of the Culling panel, and then press {toggle} twice. "
            f"{seen} (The method {method.base} culls only where that is quicker.)"
        )
    if not method.culls:
        return f"Press {toggle} once more to cull again. {seen}"
    if c.frame is not None and not _culls(c) and (c.active or c.scheduler.awaits):
        return f"The method {method.base} has culled nothing in this picture, but another one is on its way."
    if c.frame is not None and not _culls(c):
        again = key("Trace again")
        return f"The method {method.base} has culled nothing here yet. Press {again} to trace the picture once more."
    return f"Press {toggle} twice. {seen}"


def _has_seen_modes(c: Controller) -> Iterator[None]:
    wanted = {View.OCCLUSION, View.SHADOW}
    while wanted:
        yield
        wanted.discard(c.session.draw.view)


def _show_modes(c: Controller, show_panel: Callable[[str], None]) -> Iterator[float]:
    show_panel("View")
    for view in (View.OCCLUSION, View.SHADOW, View.COLOR):
        c.session.set_draw(view=view)
        yield SECONDS


def _has_clicked_a_shadow(c: Controller) -> Iterator[None]:
    while not _in_shadow(c):
        yield


def _hidden_by_another(one: Explanation, primitive: int) -> bool:
    """Whether another primitive is in the way of all of a light."""
    return one.due and not one.reached and one.blocker not in (None, primitive)


def _in_shadow(c: Controller) -> bool:
    """Whether the pixel that was clicked is in the shadow of some light."""
    answer = c.inspector.answer
    return (
        c.selection.picked is not None
        and answer is not None
        and any(one.blocked_at is not None for one in answer.lights)
    )


def _click_a_shadow(c: Controller, show_panel: Callable[[str], None]) -> Iterator[float]:
    """Of places from the middle on, the first whose ray to some light is culled, with that light chosen, so that the
    Inspector begins with what blocks it; where there is none, one that is in shadow all the same."""
    show_panel("Inspector")
    c.session.set_draw(view=View.COLOR)
    in_shadow = None
    for at in _PLACES:
        c.selection.select(at)
        if c.selection.picked is None or c.selection.picked.dynamic:
            continue
        yield from _until(lambda: c.inspector.answer is not None)
        answer, primitive = c.inspector.answer, c.selection.picked.primitive
        blocked = [one for one in answer.lights if _hidden_by_another(one, primitive)] if answer is not None else []
        told = {one.light: one.fate for one in c.inspector.why.reasons} if c.inspector.why is not None else {}
        culled = [one.light for one in blocked if told.get(one.light) is Fate.CULLED]
        if culled:
            c.settings.set_light(culled[0])
            yield SECONDS
            return
        if blocked and in_shadow is None:
            in_shadow = at, blocked[0].light
    if in_shadow is not None:
        c.selection.select(in_shadow[0])
        c.settings.set_light(in_shadow[1])
        yield from _until(lambda: c.inspector.answer is not None)
        yield SECONDS


def _has_run_a_zoom_test(c: Controller) -> Iterator[None]:
    last = c.runs.zoom_test
    while c.runs.zoom_test is last or c.runs.zoom_test is None or c.runs.current is c.runs.zoom_test:
        yield


def _run_a_zoom_test(c: Controller, show_panel: Callable[[str], None]) -> Iterator[float]:
    """Towards a small primitive that is fully rendered, if the picture has one: what is not has no count to grow
    from, and what is large cannot become so many times as large."""
    show_panel("Zoom test")
    yield from _until(lambda: not c.scheduler.awaits)
    small = _small_primitive(c.frame, c) if c.frame is not None else None
    if small is not None:
        c.selection.select_primitive(small)
    elif c.selection.picked is None or c.selection.picked.dynamic:
        yield from _click_a_shadow(c, show_panel)
    yield SECONDS
    c.runs.start_zoom_test()
    while c.runs.current is not None:
        yield 0.1


def _small_primitive(frame: Frame, c: Controller) -> int | None:
    """The number of a primitive at rest, in the scene as it was read, that is fully rendered in about `_ZOOMED` pixels,
    and has set some shadow mode; None where there is none."""
    now = c.session.edited
    if now is None or not frame.settings.keeps_modes or Method.parse(frame.settings.method).uses_cells:
        return None
    counts, modes = frame.pixel_count, frame.modes
    small = (occlusion_mode(modes) == OcclusionMode.FULLY_RENDERED) & (counts > 0) & (modes >> modes.dtype.type(2) > 0)
    numbers = np.nonzero(small)[0]
    numbers = numbers[np.argsort(np.abs(np.log(counts[numbers] / _ZOOMED)), kind="stable")]
    found = next((int(n) for n in numbers if now.scene.object_of(int(n)) == 0), None)
    return None if found is None else int(now.primitives[found])


def _last_word(c: Controller, tested: bool) -> str:
    """What the zoom test has shown, if there was one, and where to go on."""
    test = c.runs.zoom_test
    seen = zoom_test_in_words(test.results) if tested and test is not None and test.results is not None else ""
    more = "Next: BART's Kitchen (File > Open), methods compared along a path as in Table 1 (panel Experiment), and "
    more += "docs/viewer.md, which explains all panels."
    return f"{seen} {more}".strip()


def zoom_test_in_words(results: Results) -> str:
    """With which factor the primitive was examined anew at which steps, and how many of its pixels were wrong."""
    said = []
    for one in results.approaches:
        steps = " and ".join(map(str, one.examined_anew))
        anew = f"examined anew at step {steps}" if steps else "never examined anew"
        wrong = f"at most {one.most_wrong:,} pixels wrong" if one.most_wrong else "no pixel wrong"
        said.append(f"factor {one.factor:g}: {anew}, {wrong}")
    return f"Zoom test, {'; '.join(said)}." if said else ""


STEPS = (
    Step(
        "Fly",
        lambda c, key: (
            f"Hold {key('Fly forward')}, {key('Fly left')}, {key('Fly back')} or {key('Fly right')} to move, and drag "
            f"the picture with the mouse to look around. {key('Reset camera')} takes you back."
        ),
        _has_flown,
        _fly,
    ),
    Step(
        "Turn culling off and on",
        _how_to_toggle,
        _has_toggled_culling,
        _toggle_culling,
        "Culling is on, then off, so that every shadow ray is traced, and on again, as it stays. The picture looks the "
        "same: see the bar above it, hatched while culling is off, and the row Traced in the Statistics panel.",
    ),
    Step(
        "See the modes",
        lambda c, key: (
            f"Press {key(View.OCCLUSION.label)}: green surfaces were fully rendered, orange ones are partly hidden. "
            f"Press {key(View.SHADOW.label)}: what is in the shadow of one light, lit by it, or both. "
            f"{key('Next light')} chooses the next light, {key(View.COLOR.label)} shows the picture again."
        ),
        _has_seen_modes,
        _show_modes,
    ),
    Step(
        "Click a shadow",
        lambda c, key: (
            "Click a dark spot in the picture. The Inspector says in a sentence why its shadow ray is culled or "
            "traced, and lines show the shadow rays."
        ),
        _has_clicked_a_shadow,
        _click_a_shadow,
    ),
    Step(
        "Run a zoom test",
        lambda c, key: (
            "Open the panel Zoom test and press Start. The camera moves towards the surface that you clicked, and "
            "the plot shows whether culling misses a shadow that can only be seen from close up."
        ),
        _has_run_a_zoom_test,
        _run_a_zoom_test,
        "The camera moves towards a small primitive, once with each zoom factor. When its pixels, the blue line, have "
        "reached the green limit, so many times their highest number, it is examined anew (§2.6). Red: wrong pixels.",
    ),
)
