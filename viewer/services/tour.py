"""Short steps through the program: each says what to do, and ends when the user has done it.

A step is an entry of `STEPS`: a text, in which {Next light} is the key of that command, and conditions that must hold
once, one after another.  The last has none, and stays until it is dismissed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from tracer.method import Method
from viewer.services.controller import Controller
from viewer.state.methods import BY_MODES
from viewer.state.views import View

Condition = Callable[[Controller], bool]


@dataclass(frozen=True)
class Step:
    """See the module."""

    title: str
    text: str | Callable[[Controller], str]
    conditions: tuple[Condition, ...]


class Tour:
    """`step` is the one that is next, None while no tour is being taken."""

    def __init__(self, controller: Controller, key: Callable[[str], str]) -> None:
        """`key` returns the key of a command as the user reads it, or else where its menu is."""
        self._c, self._key = controller, key
        self.step: Step | None = None
        self._held = 0  # of the step's conditions

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

    def update(self) -> None:
        """See whether what is next of the step is done, once per frame."""
        if self.step is None or not self.step.conditions or self._c.frame is None:
            return
        self._held += self.step.conditions[self._held](self._c)
        if self._held == len(self.step.conditions):
            self.skip()

    def _go_to(self, step: Step | None) -> None:
        self.step, self._held = step, 0


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
    """Return whether the pixel that was clicked is in the shadow of another primitive."""
    picked, answer = c.selection.picked, c.inspector.why
    if picked is None or answer is None:
        return False
    return any(not one.lit and one.blocker not in (-1, picked.primitive) for one in answer.reasons)


def _tests(c: Controller) -> bool:
    return c.runs.current is not None and c.runs.current is c.runs.zoom_test


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
        (_flies,),
    ),
    Step("Turn culling off and on", _how_to_toggle, (_shows_all_traced, _shows_culling)),
    Step(
        "See the modes",
        f"Press {{{View.OCCLUSION.label}}}: green surfaces were fully rendered, orange ones are partly hidden. Then "
        f"press {{{View.SHADOW.label}}}: what is in the shadow of one light, lit by it, or both. {{Next light}} "
        f"chooses the next light, {{{View.COLOR.label}}} shows the picture again.",
        (_shows(View.OCCLUSION), _shows(View.SHADOW)),
    ),
    Step(
        "Click a shadow",
        "Click a dark spot in the picture. The Inspector says in a sentence why its shadow ray is culled or traced, "
        "and lines show the shadow rays.",
        (_in_shadow,),
    ),
    Step(
        "Run a zoom test",
        "Open the panel Zoom test and press Start. The camera moves towards the surface that you clicked, and the plot "
        "shows whether culling misses a shadow that can only be seen from close up.",
        (_tests, lambda c: not _tests(c)),
    ),
    Step(
        "The tour is done",
        "Next: BART's Kitchen (File > Open), methods compared along a path as in Table 1 (panel Experiment), and "
        "docs/viewer.md, which explains all panels.",
        (),
    ),
)
