"""A comparison in the window: what of A and B is brought to the GPU, what is seen of the two, and what is saved."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.output.compared import composed as composed_of
from viewer.output.compared import difference_legend
from viewer.output.legend_parts import Legend
from viewer.services.comparing import Difference
from viewer.state.comparison import Side, Way, difference_words
from viewer.state.marks import wipe_column
from viewer.state.picking import pixel_at
from viewer.state.values import words_at
from viewer.state.worst import Spot, with_rings
from viewer.window.compared import SignedDifference
from viewer.window.display import Display, Look
from viewer.window.ui import Ui

PICTURE, OF_A = "picture", "A"
"""What the magnifier calls what fills the picture, and A beside it."""

Words = tuple[Frame, Callable[[int, int], tuple[str, ...]]]
Seen = tuple[Side, Side, Way]


def read_key(ui: Ui) -> None:
    """While the key is held, A is seen."""
    io, state = imgui.get_io(), ui.controller.comparing.state
    free = not (io.want_text_input or io.key_ctrl or io.key_alt or io.key_super or io.key_shift)
    state.held = state.on and free and ui.keyboard.is_down(ui.keymap.of("Show A"))


def draw(ui: Ui, look: Look) -> None:
    """Bring to the GPU what is to be seen besides the live picture, which is drawn with this look."""
    c, compared = ui.controller, ui.graphics.compared
    if compared is None:
        return
    sides = c.comparing.sides
    if sides is None:
        compared.release()
        return
    a, b = sides
    found = c.comparing.difference(a, b) if c.comparing.state.way is Way.DIFFERENCE else None
    if found is not None:
        compared.difference.draw(found.pixels, c.comparing.limit(found))
    if found is None or c.comparing.state.held:
        compared.draw_a(a.frame, _look_of_a(ui, look, a, b))


def _look_of_a(ui: Ui, look: Look, a: Side, b: Side) -> Look:
    session = ui.controller.session
    span = look.span if a.view is b.view else session.spans.get(a.view)
    return replace(look, view=a.view, light=a.light, selected=-1, line=False, span=span)


def shown(ui: Ui) -> Seen | None:
    """A, B and the way in which both are seen now; None where only B is."""
    c, compared = ui.controller, ui.graphics.compared
    sides = c.comparing.sides
    if sides is None or compared is None:
        return None
    way = c.comparing.state.way
    if way is Way.DIFFERENCE and compared.difference.texture_id is not None:
        if c.comparing.difference(*sides) is not None:
            return *sides, way
    if compared.a_texture is None:
        return None
    return *sides, Way.FLIP if way is Way.DIFFERENCE else way


def difference(ui: Ui) -> Difference | None:
    """The signed difference, while that is seen."""
    seen = shown(ui)
    if seen is None or seen[2] is not Way.DIFFERENCE or shows_a(ui):
        return None
    return ui.controller.comparing.difference(seen[0], seen[1])


def marked(ui: Ui) -> tuple[Spot, ...]:
    """The pixels of a signed difference that have rings."""
    found = difference(ui) if ui.controller.preferences.mark_wrong else None
    return () if found is None else found.worst


def shows_a(ui: Ui) -> bool:
    """Whether it is A alone that is seen, of the ways that show one at a time or while the key is held."""
    state, compared = ui.controller.comparing.state, ui.graphics.compared
    there = compared is not None and compared.a_texture is not None and shown(ui) is not None
    return there and state.shows_a(time.monotonic()) and state.way is not Way.SIDE


def filling(ui: Ui) -> Display | SignedDifference | None:
    """What fills the picture: B, or A, or their difference; A's part of a wipe is drawn over it."""
    seen, compared = shown(ui), ui.graphics.compared
    if seen is None or compared is None:
        return ui.graphics.display
    if shows_a(ui):
        return compared.a
    return compared.difference if seen[2] is Way.DIFFERENCE else ui.graphics.display


def magnify(ui: Ui, look: Look) -> None:
    """Where single pixels are to be seen, draw what is shown as large as it is shown, with crisp pixels."""
    magnifier, size = ui.graphics.magnifier, ui.picture.size
    if magnifier is None or min(size) < 1:
        return
    seen = shown(ui)
    beside = seen is not None and seen[2] in (Way.SIDE, Way.WIPE) and not shows_a(ui)
    for name, drawn in (
        (PICTURE, filling(ui)),
        (OF_A, ui.graphics.compared.a if beside and ui.graphics.compared is not None else None),
    ):
        picture = drawn.picture if drawn is not None else None
        of_a = seen is not None and ui.graphics.compared is not None and drawn is ui.graphics.compared.a
        view = seen[0].view if seen is not None and of_a else look.view
        smooth = look.smooth and view.is_smooth and not isinstance(drawn, SignedDifference)
        enlarged = picture is not None and (size[0] > picture.size[0] or not ui.controller.session.zoom.fits)
        if drawn is not None and enlarged and not smooth:
            magnifier.draw(name, picture, drawn.version, ui.controller.session.zoom, size)
        else:
            magnifier.drop(name)


def legend(ui: Ui) -> Legend | None:
    """Of the signed difference, while that is seen."""
    found, comparing = difference(ui), ui.controller.comparing
    if found is None:
        return None
    return difference_legend(found.apart, found.values, comparing.limit(found), len(marked(ui)))


def words(ui: Ui, side: Side | None = None) -> Words | None:
    """The frame whose pixels are seen, and what each of them says: those of a side, or of all that fills the picture;
    None without a frame."""
    c, seen = ui.controller, shown(ui)
    shares = c.preferences.work_shares
    if side is None and seen is not None and shows_a(ui):
        side = seen[0]
    if side is None:
        side = c.comparing.b
    if side is None:
        return None
    own = side

    def of(one: Side, x: int, y: int) -> tuple[str, ...]:
        at = pixel_at(one.frame, (x + 0.5) / own.frame.width, (y + 0.5) / own.frame.height)
        return words_at(one.frame, one.view, one.light, *at, shares, c.session.cut)

    if seen is not None and own.frame is seen[1].frame and seen[2] is Way.DIFFERENCE:
        found = c.comparing.difference(seen[0], seen[1])
        if found is not None:
            return own.frame, lambda x, y: difference_words(found.pixels, found.values, x, y)
    if seen is not None and own.frame is seen[1].frame and seen[2] is Way.WIPE:
        column = wipe_column(own.frame.width, c.session.wipe)
        return own.frame, lambda x, y: of(seen[0] if x < column else seen[1], x, y)
    return own.frame, lambda x, y: of(own, x, y)


def composed(ui: Ui, b: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture to save: B as it was drawn, (h, w, 3) uint8, and what is compared with it."""
    seen, compared = shown(ui), ui.graphics.compared
    if seen is None or compared is None:
        return b
    alone = shows_a(ui)
    if seen[2] is Way.DIFFERENCE and not alone:
        return with_rings(compared.difference.read(), marked(ui))
    return composed_of(compared.read_a(), b, seen[2], ui.controller.session.wipe, alone)
