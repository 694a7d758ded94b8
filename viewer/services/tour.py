"""Short steps through the paper: each says what to do, and ends when that was done and seen.

A step is an entry of `STEPS`: a text, in which {Next light} is the key of that command, and its parts, one after
another: a condition that must hold once, and what brings it about: for everybody where it sets the stage, else when the
step is shown to the user.  The last step has no parts, and stays until it is dismissed."""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tracer.method import Method, title_of
from viewer.services.controller import Controller
from viewer.services.paper_figures import FIGURE_4, SIDE, Act, Condition, Part, is_open, open_scene, opened
from viewer.state import verified
from viewer.state.methods import BY_MODES, with_base
from viewer.state.views import View
from viewer.util.resources import default_scene

SECONDS = 4.0  # that what was done can be looked at
_PLAYED, _PICTURES = 20, 8  # frames of the path, and pictures of them, in which shadows are seen to move
FAILS, EXAMINED = 20, 28
"""Frames of the scene figure4: the shadow is missing, and after the triangle was examined anew it is there."""
_PACE: dict[str, Any] = {"width": SIDE, "height": SIDE, "every_frame": True}
_RULES: dict[str, Any] = {"method": BY_MODES, "symmetric": False, "zoom_factor": 4.0}
_PLACES = itertools.cycle(  # where a shadow is looked for, in parts of the picture's size: from its middle on
    sorted(itertools.product(np.arange(1, 14) / 14.0, repeat=2), key=lambda at: np.hypot(at[0] - 0.5, at[1] - 0.5))
)


@dataclass(frozen=True)
class Step:
    """See the module; `commands` can be run from the last one; `in_figure_4` it speaks of that scene alone, and time
    stands still before its last part."""

    title: str
    text: str | Callable[[Controller], str]
    parts: tuple[Part, ...] = ()
    commands: tuple[str, ...] = ()
    in_figure_4: bool = False


class Tour:
    """`step` is the one that is next, None while no tour is being taken."""

    def __init__(self, controller: Controller, key: Callable[[str], str]) -> None:
        """`key` returns the key of a command as the user reads it, or else where its menu is."""
        self._c, self._key = controller, key
        self.step: Step | None = None
        self._held = 0  # of the step's parts
        self._shows, self._until = False, 0.0

    @property
    def is_done(self) -> bool:
        """Whether all of the step was done, and the next one comes in a moment."""
        return self.step is not None and 0 < len(self.step.parts) == self._held and not self.lacks_figure_4

    @property
    def lacks_figure_4(self) -> bool:
        """Whether another scene was opened than the step is about."""
        step = self.step
        if step is None or not step.in_figure_4 or is_open(self._c, FIGURE_4):
            return False
        return self._held > 0 or not step.parts[0].sets_stage

    def text(self, step: Step) -> str:
        """Return what to do in a step, as things are, with the keys that do it now; what is done is not asked again."""
        if self.lacks_figure_4:
            return "Open Figure 4 again: Show me."
        if self.is_done and step is STEPS[0]:
            return _THE_SAME
        text = step.text if isinstance(step.text, str) else step.text(self._c)
        return re.sub(r"\{(.+?)\}", lambda name: self._key(name[1]), text)

    def start(self) -> None:
        """Begin with the first step."""
        self._c.selection.clear()  # what was clicked before was not clicked for the tour
        if is_open(self._c, FIGURE_4):  # of the last tour
            open_scene(default_scene())(self._c)
        self._go_to(STEPS[0])

    def end(self) -> None:
        """Take the tour away."""
        self._go_to(None)

    def skip(self) -> None:
        """Go on to the next step; after the last the tour ends."""
        if self.step is not None:
            self._go_to(next(iter(STEPS[STEPS.index(self.step) + 1 :]), None))

    def back(self) -> None:
        """Go back to the step before, which is to be done once more."""
        self._c.selection.clear()  # what was done for it
        self._c.session.set_draw(view=View.COLOR)
        if self.step is not None:
            self._go_to(STEPS[max(STEPS.index(self.step) - 1, 0)])

    def show(self) -> None:
        """Do the step for the user, part by part, each of which can be looked at for a moment."""
        if self.lacks_figure_4:
            self._go_to(next(step for step in STEPS if step.in_figure_4))
        self._shows = True

    def update(self) -> None:
        """See whether the next part of the step is done, or do it, once per frame."""
        if self.step is None or not self.step.parts or self._c.frame is None or self.lacks_figure_4:
            return
        if time.monotonic() < self._until:
            return
        if self._held == len(self.step.parts):
            self.skip()
            return
        part = self.step.parts[self._held]
        if self.step.in_figure_4 and part is self.step.parts[-1]:
            self._c.session.playing = False
        if self._shows or part.sets_stage:
            part.act(self._c)
        if part.holds(self._c):
            self._held += 1
            at_once = part.sets_stage or any(coming.sets_stage for coming in self.step.parts[self._held :])
            self._until = 0.0 if at_once else time.monotonic() + SECONDS

    def _go_to(self, step: Step | None) -> None:
        if step is None and is_open(self._c, FIGURE_4):
            self._c.session.give_size_back()
        self.step, self._held, self._shows, self._until = step, 0, False, 0.0


# --- conditions ------------------------------------------------------------------------------------


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
    return c.frame is not None and c.frame.statistics.shadow.traced < c.frame.statistics.shadow.due


def _shows(view: View) -> Condition:
    return lambda c: c.session.draw.view is view


def _shadows_moved(c: Controller) -> bool:
    """Return whether the newest pictures show the shadows of moving objects over some of the path."""
    newest = itertools.takewhile(lambda one: one.state.draw.view is View.MOVING_SHADOW,
                                 reversed(c.history.records.values()))  # fmt: skip
    times = {one.state.time for one in newest}
    return len(times) >= _PICTURES and c.session.frame_at(max(times)) - c.session.frame_at(min(times)) >= _PLAYED


def _shows_wrong(c: Controller) -> bool:
    return c.session.draw.view is View.DIFFERENCE and c.frame is not None and verified.is_wrong(c.frame.statistics)


def _is_shadowed(c: Controller) -> bool:
    """Return whether the pixel that was clicked is in the shadow of another primitive."""
    picked, answer = c.selection.picked, c.inspector.why
    if picked is None or answer is None:
        return False
    return any(not one.lit and one.blocker not in (-1, picked.primitive) for one in answer.reasons)


def _at_least(number: int) -> Condition:
    """Return whether the picture shows a frame of figure4, or a later one."""
    return lambda c: is_open(c, FIGURE_4) and c.frame is not None and c.session.frame_at(c.frame.time) >= number


# --- what brings them about ------------------------------------------------------------------------


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
    """Click one place after another, until one is in shadow."""
    if not _is_shadowed(c) and (c.selection.picked is None or c.inspector.why is not None):
        c.session.set_draw(view=View.COLOR)
        c.selection.select(next(_PLACES))


def _is_staged(c: Controller) -> bool:
    """Return whether figure4 is traced frame by frame, as its file says."""
    pace, settings = c.session.state.pace, c.session.settings
    return pace.fixed_size and replace(pace, **_PACE) == pace and replace(settings, **_RULES) == settings


def _stage(c: Controller) -> None:
    """Learn the modes of figure4 from afar."""
    c.settings.change(**_RULES)
    c.session.fix_size(**_PACE)
    c.session.set_draw(view=View.COLOR)
    c.motion.follow_path(True)
    c.session.go_to_frame(0)
    c.reset_modes()
    c.session.playing = True


def _stop(c: Controller) -> None:
    c.session.playing = False


def _show_alone(c: Controller) -> None:
    """Let nothing cover the few pixels of figure4."""
    c.selection.clear()
    c.session.set_draw(view=View.COLOR)


def _play(c: Controller) -> None:
    c.session.playing = True


# --- the steps -------------------------------------------------------------------------------------

_THE_SAME = "The picture stays the same, but without culling every shadow ray is traced: see the bar above it."


def _how_to_toggle(c: Controller) -> str:
    method = Method.parse(c.session.settings.method)
    if method.adaptive:
        return (
            f"Choose {title_of(BY_MODES)}, the published method, above the picture, and then press {{Shadow culling}} "
            f"twice. {_THE_SAME} ({method.kind.title} culls only where that is quicker.)"
        )
    if method.culls and c.frame is not None and not _saves(c) and not c.active:
        return f"{method.kind.title} has culled nothing here yet. Press {{Trace again}} to trace once more."
    return f"Press {{Shadow culling}} {'twice' if method.culls else 'once more to cull again'}. {_THE_SAME}"


def _rule_of_four(c: Controller) -> str:
    """Say how many times as many pixels the triangle of figure4 covers as when it was last examined."""
    now, before = (int(c.frame.pixel_count[0]), int(c.frame.highest_count[0])) if c.frame is not None else (0, 0)
    told = "So it was: the shadow is there" if now < 2 * before else "Press {Play} to come near: the shadow appears"
    return (
        "A primitive that covers more than 4 times the pixels it had when it was examined last is examined anew "
        f"(§2.6). {told}. Now it covers {now:,} pixels, and {before:,} when it was examined last: "
        f"{now / max(before, 1):.1f} times."
    )


STEPS = (
    Step(
        "What shadow rays cost", _how_to_toggle,
        (Part(_shows_all_traced, _stop_culling), Part(_shows_culling, _cull_again)),
    ),
    Step(
        "Seen whole, or not",
        f"Press {{{View.OCCLUSION.label}}}. Green primitives were seen whole in some picture; orange ones are partly "
        "hidden by others. Only what was seen whole is culled (§2.3).",
        (Part(_shows(View.OCCLUSION), _show(View.OCCLUSION)),),
    ),
    Step(
        "What their shadow rays have met",
        f"Press {{{View.SHADOW.label}}}: in full shadow, rays to this light are skipped, in non-shadow, tested "
        f"against dynamic objects only (§2.4). {{Next light}} shows another light, {{{View.COLOR.label}}} the picture.",
        tuple(Part(_shows(view), _show(view)) for view in (View.SHADOW, View.COLOR)),
    ),
    Step(
        "Why, for one pixel",
        "Click a dark spot in the picture. The Inspector says why its shadow ray is culled or traced, and lines show "
        "the shadow rays.",
        (Part(_is_shadowed, _click_a_shadow),),
    ),
    Step(
        "Shadows that move",
        f"Press {{{View.MOVING_SHADOW.label}}}, then {{Play}}: the shadows of moving objects fall on primitives in "
        "non-shadow mode, and are right, as their rays are tested against dynamic objects.",
        (
            Part(lambda c: c.session.scene is not None and len(c.session.scene.objects) > 1,
                 open_scene(default_scene()), True),
            Part(_shows(View.MOVING_SHADOW), _show(View.MOVING_SHADOW)),
            Part(_shadows_moved, _play),
        ),
    ),
    Step(
        "Where the method fails",
        "The paper's Figure 4. From afar no shadow ray of this triangle hit the small ball, so its mode is non-shadow. "
        f"Now the ball's shadow is missing. Press {{{View.DIFFERENCE.label}}}: the marked pixels are wrong.",
        (
            opened(FIGURE_4),
            Part(_is_staged, _stage, True),
            Part(_at_least(FAILS), lambda c: None, True),
            Part(lambda c: not c.session.playing, _stop, True),
            Part(_shows_wrong, _show(View.DIFFERENCE)),
        ),
        in_figure_4=True,
    ),
    Step(
        "The rule of four", _rule_of_four,
        (
            Part(lambda c: c.session.playing or _at_least(EXAMINED)(c), _play),
            Part(_shows(View.COLOR), _show_alone, True),
            Part(_at_least(EXAMINED), lambda c: None, True),
            Part(lambda c: not c.session.playing, _stop),  # or the path would begin anew, from afar
        ),
        in_figure_4=True,
    ),
    Step(
        "What next",
        "Fly with {Fly forward}, {Fly left}, {Fly back} and {Fly right}, and look around by dragging. Open another "
        "scene ({Open...}), let Hunt find wrong pixels in it, or repeat the paper's results:",
        commands=("Table 1", "Figure 4"),
    ),
)  # fmt: skip
