"""Short steps through the program: each says what to do, and ends when the user has done it.

A step is an entry of `STEPS`: a text, in which {Next light} is the key of that command, and its parts, one after
another: a condition that must hold once, and what brings it about when the step is shown to the user.  The last step
has none, and stays until it is dismissed."""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.method import Method
from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.state import navigation
from viewer.state.methods import BY_MODES, with_base
from viewer.state.views import View

SECONDS = 2.0  # that a picture stays when it is shown
PIXELS = 150.0  # of what a shown zoom test goes to: few enough to become many, and many enough to be seen
_PLACES = itertools.cycle(  # where a shadow is looked for, in parts of the picture's size: from its middle on
    sorted(itertools.product(np.arange(1, 14) / 14.0, repeat=2), key=lambda at: np.hypot(at[0] - 0.5, at[1] - 0.5))
)

Condition = Callable[[Controller], bool]
Act = Callable[[Controller], object]
"""Brings a condition about; called in each frame of the window until that holds."""


@dataclass(frozen=True)
class Step:
    """See the module; `panel` is the one to look at."""

    title: str
    text: str | Callable[[Controller], str]
    parts: tuple[tuple[Condition, Act], ...] = ()
    panel: str = ""


class Tour:
    """`step` is the one that is next, None while no tour is being taken."""

    def __init__(self, controller: Controller, open_panel: Callable[[str], None], key: Callable[[str], str]) -> None:
        """`key` returns the key of a command as the user reads it, or else where its menu is."""
        self._c, self._open_panel, self._key = controller, open_panel, key
        self.step: Step | None = None
        self._held = 0  # of the step's parts
        self._shows, self._until = False, 0.0

    def text(self, step: Step) -> str:
        """Return what to do in a step, as things are, with the keys that do it now."""
        text = step.text if isinstance(step.text, str) else step.text(self._c)
        return re.sub(r"\{(.+?)\}", lambda name: self._key(name[1]), text)

    def toggle(self) -> None:
        """Begin the tour, or end it."""
        (self.start if self.step is None else self.end)()

    def start(self) -> None:
        """Begin with the first step."""
        self._c.selection.clear()  # what was clicked before was not clicked for the tour
        self._go_to(STEPS[0])

    def end(self) -> None:
        """Take the tour away."""
        self._go_to(None)

    def skip(self) -> None:
        """Go on to the next step; after the last the tour ends."""
        if self.step is not None:
            self._go_to(next(iter(STEPS[STEPS.index(self.step) + 1 :]), None))

    def show(self) -> None:
        """Do the step for the user, part by part, each of which can be looked at for a moment."""
        if self.step is not None and self.step.parts:
            self._shows = True
            if self.step.panel:
                self._open_panel(self.step.panel)

    def update(self) -> None:
        """See whether the next part of the step is done, or do it, once per frame."""
        if self.step is None or not self.step.parts or self._c.frame is None or time.monotonic() < self._until:
            return
        if self._held == len(self.step.parts):
            self.skip()
            return
        holds, act = self.step.parts[self._held]
        if self._shows:
            act(self._c)
        if holds(self._c):
            self._held += 1
            self._until = time.monotonic() + SECONDS * self._shows

    def _go_to(self, step: Step | None) -> None:
        self.step, self._held, self._shows, self._until = step, 0, False, 0.0


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


def _shadowed(c: Controller) -> int | None:
    """Return a light in whose shadow the pixel is that was clicked: that of another primitive."""
    picked, answer = c.selection.picked, c.inspector.why
    if picked is None or answer is None:
        return None
    by_others = (one.light for one in answer.reasons if not one.lit and one.blocker not in (-1, picked.primitive))
    return next(by_others, None)


def _in_shadow(c: Controller) -> bool:
    return _shadowed(c) is not None


def _tests(c: Controller) -> bool:
    return c.runs.current is not None and c.runs.current is c.runs.zoom_test


# --- what brings them about ------------------------------------------------------------------------


def _fly(c: Controller) -> None:
    c.motion.glide(navigation.fly(c.session.camera, 0.0, 0.0, 0.5 * c.motion.pace, c.motion.world_up))


def _stop_culling(c: Controller) -> None:
    """Switch culling off, once it is seen; a method that may cull nothing gives way first."""
    method = c.session.settings.method
    if Method.parse(method).adaptive:
        c.settings.change(method=with_base(method, BY_MODES))
    elif _shows_culling(c):
        c.settings.toggle_culling()


def _cull_again(c: Controller) -> None:
    if not Method.parse(c.session.settings.method).culls:
        c.settings.toggle_culling()


def _show(view: View) -> Act:
    return lambda c: c.session.set_draw(view=view)


def _click_a_shadow(c: Controller) -> None:
    """Click one place after another, and choose the light in whose shadow one is."""
    light = _shadowed(c)
    if light is not None:
        c.settings.set_light(light)
    elif c.selection.picked is None or c.inspector.why is not None:
        c.session.set_draw(view=View.COLOR)
        c.selection.select(next(_PLACES))


def _start_zoom_test(c: Controller) -> None:
    """Go towards a small primitive that is fully rendered, if the picture has one: what is not has no count to grow
    from, and what is large cannot become so many times as large."""
    shown = c.scheduler.activity in (Activity.RESTING, Activity.ADDING_SAMPLES)
    if not shown or c.runs.current is not None:
        return
    small = _small_primitive(c)
    if small is not None:
        c.selection.select_primitive(small)
    if c.selection.picked is None:
        _click_a_shadow(c)
    else:
        c.runs.start_zoom_test()


def _small_primitive(c: Controller) -> int | None:
    """Return the number of a static primitive, in the scene as it was read, that is fully rendered in about PIXELS."""
    now, frame = c.session.edited, c.frame
    if now is None or frame is None or not frame.settings.keeps_modes or Method.parse(frame.settings.method).uses_cells:
        return None
    whole = np.nonzero((occlusion_mode(frame.modes) == OcclusionMode.FULLY_RENDERED) & (frame.pixel_count > 0))[0]
    whole = whole[np.argsort(np.abs(np.log(frame.pixel_count[whole] / PIXELS)), kind="stable")]
    return next((int(now.primitives[n]) for n in whole if now.scene.object_of(int(n)) == 0), None)


# --- the steps -------------------------------------------------------------------------------------

_THE_SAME = (
    "The picture looks the same, but without culling every shadow ray is traced: see the bar above the picture, "
    "pale while culling is off, and the row Traced in the Statistics panel."
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
        ((_flies, _fly),),
    ),
    Step(
        "Turn culling off and on", _how_to_toggle,
        ((_shows_all_traced, _stop_culling), (_shows_culling, _cull_again)), "Statistics",
    ),
    Step(
        "See the modes",
        f"Press {{{View.OCCLUSION.label}}}: green surfaces were fully rendered, orange ones are partly hidden. Then "
        f"press {{{View.SHADOW.label}}}: what is in the shadow of one light, lit by it, or both. {{Next light}} "
        f"chooses the next light, {{{View.COLOR.label}}} shows the picture again.",
        tuple((_shows(view), _show(view)) for view in (View.OCCLUSION, View.SHADOW)), "View",
    ),
    Step(
        "Click a shadow",
        "Click a dark spot in the picture. The Inspector says in a sentence why its shadow ray is culled or traced, "
        "and lines show the shadow rays.",
        ((_in_shadow, _click_a_shadow),), "Inspector",
    ),
    Step(
        "Run a zoom test",
        "Open the panel Zoom test and press Start. The camera moves towards the surface that you clicked, and the plot "
        "shows whether culling misses a shadow that can only be seen from close up.",
        ((_tests, _start_zoom_test), (lambda c: not _tests(c), lambda c: None)), "Zoom test",
    ),
    Step(
        "The tour is done",
        "Next: BART's Kitchen (File > Open), methods compared along a path as in Table 1 (panel Experiment), and "
        "docs/viewer.md, which explains all panels.",
    ),
)  # fmt: skip
