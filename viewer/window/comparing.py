"""A comparison in the window: what of A and B is brought to the GPU, what is seen of the two, and what is saved."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from imgui_bundle import imgui

from tracer.frame import Frame
from viewer.state.comparison import CompareMode, Side, Spot, with_rings
from viewer.state.draw_options import DrawOptions
from viewer.state.pixels import pixel_at
from viewer.views import words_at
from viewer.views.base import Highlight, Pixels, Words
from viewer.views.compare import Difference, composed, difference_legend
from viewer.views.legend import Legend
from viewer.views.wipe import wipe_column
from viewer.window.display import InWindow, PictureTexture
from viewer.window.ui import Ui

PICTURE, OF_A = "picture", "A"
"""What the magnifier calls what fills the picture, and A beside it."""

Seen = tuple[Side, Side, CompareMode]


def read_key(ui: Ui) -> None:
    """While the key is held, A is seen."""
    io, comparing = imgui.get_io(), ui.controller.comparing
    free = not (io.want_text_input or io.key_ctrl or io.key_alt or io.key_super or io.key_shift)
    comparing.held = comparing.state.on and free and ui.keyboard.is_down(ui.keymap.of("Show A"))


def draw_options(ui: Ui) -> DrawOptions:
    """Return how the newest frame is drawn: in the view that it can be drawn in, with a range for both pictures."""
    c, view = ui.controller, ui.controller.scheduler.drawn_view
    options = replace(c.session.draw, view=view, magnified=c.scheduler.magnified)
    return options.with_span(c.comparing.span(view))


def draw(ui: Ui, options: DrawOptions, smooth: bool) -> None:
    """Bring to the GPU what is to be seen besides the live picture, which is drawn with these options."""
    comparing, compared = ui.controller.comparing, ui.graphics.compared
    if compared is None:
        return
    sides = comparing.sides
    if sides is None:
        compared.release()
        return
    a, b = sides
    found = comparing.difference(a, b) if comparing.state.mode is CompareMode.DIFFERENCE else None
    if found is not None:
        compared.draw_difference(found, comparing.limit(found))
    if found is None or comparing.held:
        spans = options.spans if a.view is b.view else ui.controller.session.draw.spans
        of_a = replace(options, view=a.view, light=a.light, spans=spans)
        compared.a.draw(a.frame, of_a, InWindow(smooth=smooth, highlight=Highlight(line=False)))


def shown(ui: Ui) -> Seen | None:
    """Return A, B and the mode in which both are seen now; None where only B is."""
    comparing, compared = ui.controller.comparing, ui.graphics.compared
    sides = comparing.sides
    if sides is None or compared is None:
        return None
    mode = comparing.state.mode
    if mode is CompareMode.DIFFERENCE and compared.difference.texture_id is not None and comparing.difference(*sides):
        return *sides, mode
    if compared.a.texture_id is None:
        return None
    return *sides, CompareMode.FLIP if mode is CompareMode.DIFFERENCE else mode


def difference(ui: Ui) -> Difference | None:
    """Return the signed difference, while that is seen."""
    seen = shown(ui)
    if seen is None or seen[2] is not CompareMode.DIFFERENCE or shows_a(ui):
        return None
    return ui.controller.comparing.difference(seen[0], seen[1])


def marked(ui: Ui) -> tuple[Spot, ...]:
    """Return the pixels of a signed difference that have rings."""
    found = difference(ui) if ui.controller.session.draw.mark_wrong else None
    return () if found is None else found.worst


def shows_a(ui: Ui) -> bool:
    """Return whether A alone is seen, in the modes that show one at a time or while the key is held."""
    comparing, compared = ui.controller.comparing, ui.graphics.compared
    state, now = comparing.state, time.monotonic()
    there = compared is not None and compared.a.texture_id is not None and shown(ui) is not None
    return there and (comparing.held or state.shows_a(now)) and state.mode is not CompareMode.SIDE


def filling(ui: Ui) -> PictureTexture | None:
    """Return what fills the picture: B, or A, or their difference; A's part of a wipe is drawn over it."""
    seen, compared = shown(ui), ui.graphics.compared
    if seen is None or compared is None:
        return ui.graphics.display
    if shows_a(ui):
        return compared.a
    return compared.difference if seen[2] is CompareMode.DIFFERENCE else ui.graphics.display


def magnify(ui: Ui, options: DrawOptions, smooth: bool) -> None:
    """Where single pixels are to be seen, draw what is shown as large as it is shown, with crisp pixels."""
    magnifier, size, zoom = ui.graphics.magnifier, ui.picture.size, ui.controller.session.draw.zoom
    if magnifier is None or min(size) < 1:
        return
    seen, compared = shown(ui), ui.graphics.compared
    a = compared.a if compared is not None else None
    beside = seen is not None and seen[2] in (CompareMode.SIDE, CompareMode.WIPE) and not shows_a(ui)
    for name, drawn in ((PICTURE, filling(ui)), (OF_A, a if beside else None)):
        picture = drawn.picture if drawn is not None else None
        view = seen[0].view if seen is not None and drawn is a else options.view
        blended = smooth and view.shows_clipped and (compared is None or drawn is not compared.difference)
        enlarged = picture is not None and (size[0] > picture.size[0] or not zoom.fits)
        if drawn is not None and enlarged and not blended:
            magnifier.draw(name, picture, drawn.version, zoom, size)
        else:
            magnifier.drop(name)


def legend(ui: Ui) -> Legend | None:
    """Return the legend of the signed difference, while that is seen."""
    found = difference(ui)
    return None if found is None else difference_legend(found, ui.controller.comparing.limit(found), len(marked(ui)))


def words(ui: Ui, options: DrawOptions, side: Side | None = None) -> tuple[Frame, Callable[[int, int], Words]] | None:
    """Return the frame whose pixels are seen, and what says what each of them shows: those of a side, or of all that
    fills the picture; None without a frame."""
    c, seen = ui.controller, shown(ui)
    if side is None:
        side = seen[0] if seen is not None and shows_a(ui) else c.comparing.b
    if side is None:
        return None
    own = side

    def of(one: Side, x: int, y: int) -> Words:
        at = pixel_at(one.frame, (x + 0.5) / own.frame.width, (y + 0.5) / own.frame.height)
        return words_at(one.frame, replace(options, view=one.view, light=one.light), *at)

    if seen is not None and own.frame is seen[1].frame and seen[2] is CompareMode.DIFFERENCE:
        found = c.comparing.difference(seen[0], seen[1])
        if found is not None:
            return own.frame, found.words
    if seen is not None and own.frame is seen[1].frame and seen[2] is CompareMode.WIPE:
        column = wipe_column(own.frame.width, options.wipe)
        return own.frame, lambda x, y: of(seen[0] if x < column else seen[1], x, y)
    return own.frame, lambda x, y: of(own, x, y)


def composed_picture(ui: Ui, b: Pixels) -> Pixels:
    """Return the picture to save: B as it was drawn, and what is compared with it."""
    seen, compared = shown(ui), ui.graphics.compared
    if seen is None or compared is None:
        return b
    if seen[2] is CompareMode.DIFFERENCE and not shows_a(ui):
        return with_rings(compared.difference.read(), marked(ui))
    return composed(compared.a.read(), b, seen[2], ui.controller.session.draw.wipe, shows_a(ui))
