"""Short steps through the program: each says what to do, and ends when the user has done it.

A step is an entry of `STEPS`: a text, in which {Next light} is the key of that command; the conditions that must hold
once each, one after another, for it to be done; and a script that does it for the user."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.method import Method
from viewer.services.controller import Controller
from viewer.state import navigation
from viewer.state.methods import BY_MODES, with_base
from viewer.state.views import View

SECONDS = 2.0  # that a picture stays when it is shown
PATIENCE = 20.0  # seconds that a picture or an answer may take to come
LAST_WORD = (
    "Next: BART's Kitchen (File > Open), methods compared along a path as in Table 1 (panel Experiment), and "
    "docs/viewer.md, which explains all panels."
)
_ZOOMED = 150.0  # pixels of what a shown zoom test goes to: few enough to become many, and many enough to be seen
_PLACES = sorted(  # where a shadow is looked for, in parts of the picture's width and height: from its middle on
    ((x / 14.0, y / 14.0) for x in range(1, 14) for y in range(1, 14)),
    key=lambda at: (at[0] - 0.5) ** 2 + (at[1] - 0.5) ** 2,
)

Condition = Callable[[Controller], bool]
Script = Iterator[float]
"""Does a step; yields how many seconds to wait before it goes on."""
OpenPanel = Callable[[str], None]


@dataclass(frozen=True)
class Step:
    """See the module.  `shown` is what is to be seen while the step is done for the user, where `text` does not say
    so."""

    title: str
    text: str | Callable[[Controller], str]
    done: tuple[Condition, ...]
    show: Callable[[Controller, OpenPanel], Script]
    shown: str = ""


class Tour:
    """`step` is the one that is next, None while no tour is being taken; `over` says that the last one was done, until
    that is dismissed."""

    def __init__(self, controller: Controller, open_panel: OpenPanel, key: Callable[[str], str]) -> None:
        """`key` returns the key of a command as the user reads it, or else where its menu is."""
        self._c, self._open_panel, self._key = controller, open_panel, key
        self.step: Step | None = None
        self.over = False
        self._held = 0  # how many of the step's conditions
        self._script: Script | None = None
        self._goes_on_at = 0.0

    def text(self, step: Step) -> str:
        """Return what to do in a step, as things are, with the keys that do it now, or what is being done."""
        if self._script is not None and step is self.step and step.shown:
            return step.shown
        text = step.text if isinstance(step.text, str) else step.text(self._c)
        return re.sub(r"\{(.+?)\}", lambda name: self._key(name[1]), text)

    def toggle(self) -> None:
        """Begin the tour, or end it."""
        (self.start if self.step is None else self.end)()

    def start(self) -> None:
        """Begin with the first step."""
        self._c.selection.picked = None  # what was clicked before was not clicked for the tour
        self._go_to(STEPS[0])

    def end(self) -> None:
        """Take the tour away."""
        self._go_to(None)

    def skip(self) -> None:
        """Go on to the next step; after the last the tour ends."""
        if self.step is not None:
            self._go_to(next(iter(STEPS[STEPS.index(self.step) + 1 :]), None))

    def show(self) -> None:
        """Do the step for the user."""
        if self.step is not None:
            self._script, self._goes_on_at = self.step.show(self._c, self._open_panel), 0.0

    def update(self) -> None:
        """See whether the step is done, once per frame, and go on with what is being shown."""
        if self.step is None or self._c.frame is None:
            return
        now = time.monotonic()
        if self._script is not None and now >= self._goes_on_at:
            wait = next(self._script, None)
            self._goes_on_at = now + (wait or 0.0)
            if wait is None:
                self._script = None
        done = self.step.done
        self._held += self._held < len(done) and done[self._held](self._c)
        if self._held == len(done) and self._script is None:
            self.skip()
            self.over = self.step is None

    def _go_to(self, step: Step | None) -> None:
        self.step, self._held, self._script, self.over = step, 0, None, False


# --- conditions ------------------------------------------------------------------------------------


def _flies(c: Controller) -> bool:
    return c.motion.is_dragging and not c.session.on_path


def _shows_all_traced(c: Controller) -> bool:
    method = c.session.settings.method
    return not Method.parse(method).culls and c.frame is not None and c.frame.settings.method == method


def _shows_culling(c: Controller) -> bool:
    """Return whether the picture shows what culling saves or, once it rests, that the method saves nothing here."""
    method = Method.parse(c.session.settings.method)
    if not method.culls or c.frame is None or c.frame.settings.method != c.session.settings.method:
        return False
    return _saves(c) or not (method.adaptive or c.active)


def _saves(c: Controller) -> bool:
    """Return whether culling has saved something in the newest frame."""
    return c.frame is not None and c.frame.statistics.shadow.traced < c.frame.statistics.shadow.due


def _shows(view: View) -> Condition:
    return lambda c: c.session.draw.view is view


def _in_shadow(c: Controller) -> bool:
    """Return whether the pixel that was clicked is in the shadow of some light."""
    answer = c.inspector.answer if c.selection.picked is not None else None
    return answer is not None and any(one.blocker >= 0 for one in answer.reasons)


def _tests(c: Controller) -> bool:
    return c.runs.current is not None and c.runs.current is c.runs.zoom_test


# --- scripts ---------------------------------------------------------------------------------------


def _until(holds: Callable[[], object]) -> Script:
    """Wait for the next frame of the window, and until something has come, but not for ever."""
    end = time.monotonic() + PATIENCE
    yield 0.0
    while not holds() and time.monotonic() < end:
        yield 0.0


def _fly(c: Controller, _: OpenPanel) -> Script:
    c.motion.glide(navigation.fly(c.session.camera, 0.0, 0.0, 0.5 * c.motion.pace, c.motion.world_up))
    yield SECONDS


def _toggle_culling(c: Controller, open_panel: OpenPanel) -> Script:
    before = c.session.settings.method
    open_panel("Statistics")
    if Method.parse(before).adaptive or not _saves(c):
        c.settings.change(method=with_base(before, BY_MODES))
        c.notices.say(f"the method is {c.session.settings.method} now, as {before} has culled nothing here")
    yield from _until(lambda: _shows_culling(c))
    yield SECONDS
    for seen in (_shows_all_traced, _shows_culling):
        c.settings.toggle_culling()
        yield from _until(partial(seen, c))
        yield SECONDS


def _show_modes(c: Controller, open_panel: OpenPanel) -> Script:
    open_panel("View")
    for view in (View.OCCLUSION, View.SHADOW, View.COLOR):
        c.session.set_draw(view=view)
        yield SECONDS


def _click_a_shadow(c: Controller, open_panel: OpenPanel) -> Script:
    """Click the first of the places that is in another primitive's shadow, and choose that light."""
    open_panel("Inspector")
    c.session.set_draw(view=View.COLOR)
    for at in _PLACES:
        c.selection.select(at)
        picked = c.selection.picked
        if picked is None or picked.dynamic:
            continue
        yield from _until(lambda: c.inspector.answer is not None)
        answer = c.inspector.answer
        for one in answer.reasons if answer is not None else ():
            if not one.lit and one.blocker not in (-1, picked.primitive):
                c.settings.set_light(one.light)
                yield SECONDS
                return


def _run_a_zoom_test(c: Controller, open_panel: OpenPanel) -> Script:
    """Go towards a small primitive that is fully rendered, if the picture has one: what is not has no count to grow
    from, and what is large cannot become so many times as large."""
    open_panel("Zoom test")
    yield from _until(lambda: not c.scheduler.awaits)
    small = _small_primitive(c)
    if small is not None:
        c.selection.select_primitive(small)
    if c.selection.picked is None or c.selection.picked.dynamic:
        yield from _click_a_shadow(c, open_panel)
    yield SECONDS
    c.runs.start_zoom_test()
    while c.runs.current is not None:
        yield 0.1


def _small_primitive(c: Controller) -> int | None:
    """Return the number of a static primitive, in the scene as it was read, that is fully rendered in about `_ZOOMED`
    pixels; None where there is none."""
    now, frame = c.session.edited, c.frame
    if now is None or frame is None or not frame.settings.keeps_modes or Method.parse(frame.settings.method).uses_cells:
        return None
    whole = (occlusion_mode(frame.modes) == OcclusionMode.FULLY_RENDERED) & (frame.pixel_count > 0)
    numbers = np.nonzero(whole)[0]
    numbers = numbers[np.argsort(np.abs(np.log(frame.pixel_count[numbers] / _ZOOMED)), kind="stable")]
    return next((int(now.primitives[n]) for n in numbers if now.scene.object_of(int(n)) == 0), None)


# --- the steps -------------------------------------------------------------------------------------

_THE_SAME = (
    "The picture looks the same, but without culling every shadow ray is traced: see the bar above the picture, "
    "hatched while culling is off, and the row Traced in the Statistics panel."
)


def _how_to_toggle(c: Controller) -> str:
    method = Method.parse(c.session.settings.method)
    if method.adaptive:
        return (
            f"Choose {BY_MODES}, the published method, at the top of the Culling panel, and then press "
            f"{{Shadow culling}} twice. {_THE_SAME} (The method {method.base} culls only where that is quicker.)"
        )
    if method.culls and c.frame is not None and not _saves(c) and not c.active:
        return f"The method {method.base} has culled nothing here yet. Press {{Trace again}} to trace once more."
    return f"Press {{Shadow culling}} {'twice' if method.culls else 'once more to cull again'}. {_THE_SAME}"


STEPS = (
    Step(
        "Fly",
        "Hold {Fly forward}, {Fly left}, {Fly back} or {Fly right} to move, and drag the picture with the mouse to "
        "look around. {Reset camera} takes you back.",
        (_flies,), _fly,
    ),
    Step(
        "Turn culling off and on", _how_to_toggle, (_shows_all_traced, _shows_culling), _toggle_culling,
        f"Culling is on, then off, and on again, as it stays. {_THE_SAME}",
    ),
    Step(
        "See the modes",
        f"Press {{{View.OCCLUSION.label}}}: green surfaces were fully rendered, orange ones are partly hidden. Then "
        f"press {{{View.SHADOW.label}}}: what is in the shadow of one light, lit by it, or both. {{Next light}} "
        f"chooses the next light, {{{View.COLOR.label}}} shows the picture again.",
        (_shows(View.OCCLUSION), _shows(View.SHADOW)), _show_modes,
    ),
    Step(
        "Click a shadow",
        "Click a dark spot in the picture. The Inspector says in a sentence why its shadow ray is culled or traced, "
        "and lines show the shadow rays.",
        (_in_shadow,), _click_a_shadow,
    ),
    Step(
        "Run a zoom test",
        "Open the panel Zoom test and press Start. The camera moves towards the surface that you clicked, and the plot "
        "shows whether culling misses a shadow that can only be seen from close up.",
        (_tests, lambda c: not _tests(c)), _run_a_zoom_test,
        "The camera moves towards a small primitive, once with each zoom factor. When its pixels, the blue line, have "
        "reached the green limit, so many times their highest number, it is examined anew (§2.6). Red: wrong pixels.",
    ),
)  # fmt: skip
