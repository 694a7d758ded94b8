"""Sentences with links: words that wrap at the panel's edge, and what a click on a name does."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.inspect.reasons import SECTIONS
from tracer.inspect.why_in_words import Link, Sentence
from viewer.state.pixels import Point
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, fitted, tooltip

_Word = tuple[str, Link | None]
_TRAILING = re.compile(r"\S+\s*|\s+")


@dataclass
class Pointed:
    """The name and the light of the Inspector that the pointer is on."""

    link: Link | None = None
    light: int | None = None


def sentence(ui: Ui, said: Sentence, key: str, color: ImVec4 | None = None) -> None:
    """Write a sentence that wraps at the panel's edge; `key` tells its links from those of other sentences."""
    imgui.push_id(key)
    gap = imgui.get_style().item_spacing
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(0.0, 0.25 * gap.y))
    left, room = imgui.get_cursor_screen_pos().x, imgui.get_content_region_avail().x
    number, at = 0, left
    for group in _groups(said):
        width = sum(imgui.calc_text_size(text).x for text, _ in group)
        needed = width - imgui.calc_text_size(" ").x * group[-1][0].endswith(" ")
        if at > left and at + needed <= left + room:
            imgui.same_line(0.0, 0.0)
        else:
            at = left
        for place, (text, link) in enumerate(group):
            if place:
                imgui.same_line(0.0, 0.0)
            if link is None:
                imgui.text_colored(color or imgui.get_style_color_vec4(imgui.Col_.text), text)
            else:
                _link(ui, link, fitted(text, left + room - at), number)
                number += 1
        at += width
    imgui.pop_style_var()
    imgui.dummy(ImVec2(0.0, 0.0))
    imgui.pop_id()


def _groups(said: Sentence) -> Iterator[list[_Word]]:
    """What stays together in a line: a break may come after a blank between words, but in no link."""
    group: list[_Word] = []
    for part in said:
        words: list[_Word] = (
            [(part.text, part)] if isinstance(part, Link) else [(w, None) for w in _TRAILING.findall(part)]
        )
        for word in words:
            group.append(word)
            if word[1] is None and word[0][-1].isspace():
                yield group
                group = []
    if group:
        yield group


def _link(ui: Ui, link: Link, text: str, number: int) -> None:
    """A name: a click leads to what it stands for."""
    if link.section:
        imgui.text_colored(QUIET, text)
        tooltip(f"{link.text}  {SECTIONS[link.section]}")
        return
    if imgui.text_link(f"{text}##{number}"):
        go_to(ui, link)
    if imgui.is_item_hovered():
        ui.state(Pointed).link = link
    tooltip(_about(ui, link))


def go_to(ui: Ui, link: Link) -> None:
    """Go back to the frame, or select the pixel or the primitive, that a link stands for."""
    c = ui.controller
    selection, point = c.selection, _point(ui, link)
    if link.frame is not None:
        picked = selection.picked
        c.navigator.go(link.frame)  # which clears the selection
        selection.picked = picked
    elif point is not None:
        selection.select(point)
    elif link.primitive is not None and c.session.edited is not None:
        selection.select_primitive(int(c.session.edited.primitives[link.primitive]))


def _about(ui: Ui, link: Link) -> str:
    if link.frame is not None:
        kept = ui.controller.history.records.get(link.frame) is not None
        return f"Go to {ui.controller.navigator.name_of(link.frame)}" if kept else "This picture is no longer kept."
    if link.pixel is not None:
        return "Select this pixel" if _point(ui, link) is not None else "A pixel of another picture"
    return "Select it; while the pointer rests here, the picture outlines it"


def _point(ui: Ui, link: Link) -> Point | None:
    """The pixel of a link as a point of the picture, None where another picture is shown than the one that it is of."""
    frame = ui.controller.frame
    if link.pixel is None or frame is None or not ui.controller.inspector.names_pixels_of(frame):
        return None
    return (link.pixel[0] + 0.5) / frame.width, (link.pixel[1] + 0.5) / frame.height
