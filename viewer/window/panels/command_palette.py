"""The command palette: a line to type in, and below it what is meant by that."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from rapidfuzz import fuzz

from viewer.state.preferences import RECENT_COMMANDS
from viewer.window import setting_rows
from viewer.window.command import Command, Kind
from viewer.window.menus import ANY_POPUP, run
from viewer.window.panels import scene
from viewer.window.panels.named_states import KEYED_BOOKMARKS, preset_commands
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, fitted, paragraph, tooltip

TITLE = "##command palette"
_WIDTH, _LINES, _PAGE = 42.0, 13, 10
_ICONS = {
    Kind.COMMAND: icons.ICON_FA_ANGLE_RIGHT,
    Kind.SETTING: icons.ICON_FA_SLIDERS,
    Kind.PRESET: icons.ICON_FA_LAYER_GROUP,
    Kind.BOOKMARK: icons.ICON_FA_BOOKMARK,
    Kind.SCENE: icons.ICON_FA_CUBES,
}
_LINE = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.callback_history)
_ROW = int(imgui.SelectableFlags_.no_auto_close_popups)
_ASKED_FOR = {"Inspector": "why"}  # panels, by other words than their names
RECENT_BONUS = 15.0
"""For what was run last; less for what was run before."""
_VERBS = "open show set value switch on off apply"  # with which any of them may be asked for
_OTHER_KINDS = 4.0  # which a command goes before, where both fit alike
_MISTYPED, _ALIKE = -1000.0, 75.0  # to which is added how alike the words are, of 100, and that is at least so much


# --- what is meant -----------------------------------------------------------------------------------


def match(typed: str, label: str, elsewhere: str = "", tip: str = "", also: str = "") -> float | None:
    """How well a label fits what was typed; words may also be found in other texts.  None if one is in none.

    Words count as one of `also` (120), as they stand in the label (100), by their beginnings (80), as initials of the
    label's words (60), anywhere in it (50), `elsewhere` (30), at the beginning of a word of `tip` (10), or, much less,
    mistyped; a shorter label before a longer one."""
    label, elsewhere, tip, words = label.lower(), elsewhere.lower(), f" {tip.lower()}", typed.lower().split()
    meant = also.lower().split()
    starts = [i for i, letter in enumerate(label) if letter.isalnum() and (i == 0 or not label[i - 1].isalnum())]
    initials, score = "".join(label[i] for i in starts), -0.1 * len(label) + 25.0 * (" ".join(words) == label)
    for word in words:
        start = next((i for i in starts if label.startswith(word, i)), -1)
        if word in meant:
            score += 120.0
        elif start >= 0:
            whole = not label[start + len(word) : start + len(word) + 1].isalnum()
            score += (100.0 if whole else 80.0) - 0.05 * start
        elif len(word) > 1 and initials.startswith(word):
            score += 60.0
        elif word in label:
            score += 50.0 - 0.05 * label.find(word)
        elif word in elsewhere:
            score += 30.0
        elif f" {word}" in tip:
            score += 10.0
        elif len(word) > 3 and (alike := fuzz.partial_ratio(word, label, score_cutoff=_ALIKE)):
            score += _MISTYPED + alike
        else:
            return None
    return score


def find(typed: str, items: Sequence[Command], used: Sequence[str]) -> list[Command]:
    """What fits, best first, or else what is nearly called so; without a word all, what was used last first."""
    rank = {name: place for place, name in enumerate(used)}
    if not typed.strip():
        return sorted(items, key=lambda item: rank.get(item.name, len(rank)))
    scored = []
    for number, item in enumerate(items):
        elsewhere = f"{item.name} {item.menu} {item.kind.value} {item.also} {_VERBS}"
        score = match(typed, item.label, elsewhere, item.more, item.also)
        if score is not None:
            score -= _OTHER_KINDS if item.kind is not Kind.COMMAND else 0.0
            score += RECENT_BONUS / (1.0 + rank[item.name]) if item.name in rank else 0.0
            scored.append((-score, number))
    as_typed = [entry for entry in scored if entry[0] < -0.5 * _MISTYPED]
    return [items[number] for _, number in sorted(as_typed or scored)]


@dataclass
class Finder:
    """`typed` is what is typed, `marked` the place of the line that Enter runs, which the list scrolls to where it has
    `moved`, `setting` the setting whose value is being typed, `problem` what is wrong with that; a `fresh` line takes
    the keyboard."""

    found: list[Command] = field(default_factory=list)
    typed: str = ""
    marked: int = 0
    setting: Command | None = None
    problem: str = ""
    moved: bool = True
    fresh: bool = True

    def begin(self) -> None:
        """Open it, empty."""
        self.typed, self.marked, self.setting, self.problem = "", 0, None, ""
        self.moved = self.fresh = True

    def update(self, items: Sequence[Command], used: Sequence[str]) -> None:
        """Find what is typed among all items, as they are now."""
        if self.setting is None:
            self.found = find(self.typed, items, used)
            self.marked = min(self.marked, max(0, len(self.found) - 1))

    def type(self, text: str) -> None:
        """Another text stands in the line."""
        self.typed, self.problem = text, ""
        if self.setting is None:
            self.marked, self.moved = 0, True

    def step(self, lines: int) -> None:
        """Mark another line; past the end comes the first."""
        if self.found and self.setting is None:
            self.marked = (self.marked + lines) % len(self.found)
            self.moved = True

    @property
    def aimed(self) -> Command | None:
        """What Enter would run."""
        return self.found[self.marked] if self.setting is None and self.marked < len(self.found) else None

    def enter(self, item: Command | None) -> bool:
        """Take an item, or the value that was typed for one; returns whether it closes now, and the item is to be
        run."""
        if self.setting is not None:
            self.problem = self.setting.take(self.typed) if self.setting.take is not None else ""
            return not self.problem
        if item is None:
            return False
        if item.why_not:
            self.problem = f"{item.label}: {item.why_not}"
            return False
        if item.value is not None:
            self.setting, self.typed, self.problem, self.fresh = item, item.value, "", True
        return item.value is None


# --- the popup -----------------------------------------------------------------------------------------


def show(ui: Ui) -> None:
    """It lies at the top of the window, and goes with Escape, with a click elsewhere, and when something is run."""
    finder = ui.state(Finder)
    if Dialog.PALETTE in ui.dialogs:
        ui.close(Dialog.PALETTE)  # it is a popup from here on, which knows itself whether it is open
        finder.begin()
        imgui.open_popup(TITLE)
    if not imgui.is_popup_open(TITLE):
        return
    area, size = imgui.get_main_viewport().work_pos, imgui.get_main_viewport().work_size
    top = ImVec2(area.x + 0.5 * size.x, area.y + 0.08 * size.y)
    imgui.set_next_window_pos(top, int(imgui.Cond_.always), ImVec2(0.5, 0.0))
    imgui.set_next_window_size(ImVec2(min(em(_WIDTH), 0.95 * size.x), 0.0))
    if not imgui.begin_popup(TITLE):
        return
    preferences = ui.controller.preferences
    finder.update(items(ui), preferences.used)
    aimed = finder.aimed
    entered = _line(finder)
    clicked = _list(ui, finder) if finder.setting is None else None
    hint = finder.setting.more if finder.setting is not None else aimed.why_not if aimed is not None else ""
    if finder.problem or hint:
        paragraph(finder.problem or hint, ERROR if finder.problem else QUIET)
    chosen = clicked or finder.aimed or finder.setting
    done = (entered or clicked is not None) and finder.enter(clicked or finder.aimed)
    if done or imgui.is_key_pressed(imgui.Key.escape):
        imgui.close_current_popup()
    imgui.end_popup()
    if done and chosen is not None:
        names = [chosen.name, *(name for name in preferences.used if name != chosen.name)]
        preferences.used = names[:RECENT_COMMANDS]
        run(ui, chosen)


def close() -> None:
    """Take it away, whatever it is at."""
    if imgui.is_popup_open("", ANY_POPUP):
        imgui.internal.close_popup_to_level(0, True)


def _line(finder: Finder) -> bool:
    """The line to type in, which always has the keyboard; returns whether Enter was pressed."""

    def key(data: imgui.InputTextCallbackData) -> int:
        finder.step(1 if data.event_key == imgui.Key.down_arrow else -1)
        return 0

    for pressed, lines in ((imgui.Key.page_down, _PAGE), (imgui.Key.page_up, -_PAGE)):
        if imgui.is_key_pressed(pressed):
            finder.step(lines)
    setting = finder.setting
    if setting is not None:
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(setting.label)
        imgui.same_line()
    imgui.set_next_item_width(-1.0)
    if finder.fresh or not imgui.is_any_item_active():
        imgui.set_keyboard_focus_here()
    hint = "find commands, settings, presets, bookmarks and scenes"
    name = f"##value {setting.name}" if setting is not None else "##typed"
    flags = _LINE | (int(imgui.InputTextFlags_.auto_select_all) if setting is not None else 0)
    entered, text = imgui.input_text_with_hint(name, "" if setting is not None else hint, finder.typed, flags, key)
    finder.fresh = False
    if text != finder.typed and finder.setting is setting:
        finder.type(text)
    return bool(entered)


def _list(ui: Ui, finder: Finder) -> Command | None:
    """Show what was found; returns what was clicked."""
    if not finder.found:
        imgui.text_colored(QUIET, "no matches")
        return None
    clicked = None
    height = min(len(finder.found), _LINES) * imgui.get_text_line_height_with_spacing()
    if imgui.begin_child("found", ImVec2(0.0, min(height, 0.7 * imgui.get_main_viewport().work_size.y))):
        for number, item in enumerate(finder.found):
            if _row(ui, item, number == finder.marked):
                finder.marked, clicked = number, item
            if number == finder.marked and finder.moved:
                imgui.set_scroll_here_y()
                finder.moved = False
    imgui.end_child()
    return clicked


def _row(ui: Ui, item: Command, marked: bool) -> bool:
    imgui.push_id(item.name)
    clicked = imgui.selectable("##row", marked, _ROW)[0]
    if item.why_not or item.more:
        tooltip(item.why_not or item.more)
    imgui.same_line(em(0.3))
    imgui.text_colored(QUIET, icons.ICON_FA_CHECK if item.is_checked else _ICONS[item.kind])
    imgui.same_line(em(1.9))
    left, edge = imgui.get_cursor_pos_x(), imgui.get_content_region_avail().x
    shown, menu = ui.key_label(item.name) or item.value or "", item.menu.replace("/", " > ")
    key_room = imgui.calc_text_size(shown).x + em(0.3)
    clipped(item.label, None if not item.why_not else imgui.get_style_color_vec4(imgui.Col_.text_disabled))
    path_room = edge - key_room - imgui.calc_text_size(item.label).x - em(1.8)
    if menu and path_room > em(3.0):
        imgui.same_line(0.0, em(0.8))
        imgui.text_colored(QUIET, fitted(menu, path_room))
    if shown:
        imgui.same_line(left + edge - key_room)
        clipped(shown, QUIET)
    imgui.pop_id()
    return bool(clicked)


# --- what there is -------------------------------------------------------------------------------------


def items(ui: Ui) -> list[Command]:
    """Return everything, as it is now; commands first, in the order of the menus."""
    own = [command for command in ui.commands if command.label and command.name != Dialog.PALETTE.value]
    return [*own, *setting_rows.entries(ui), *_others(ui)]


def _others(ui: Ui) -> Iterator[Command]:
    """Return presets, panels, bookmarks and scenes."""
    c = ui.controller
    yield from preset_commands(ui)
    for label in ui.panel_labels:
        also = _ASKED_FOR.get(label, "")
        yield Command(f"panel {label}", "Panels", partial(ui.show_panel, label), title=f"Panel {label}", also=also)
    for number, mark in list(enumerate(c.bookmarks.all))[KEYED_BOOKMARKS:]:  # the others are in the menu
        go = partial(c.go_to_bookmark, number)
        yield Command(f"bookmark {number}", "go there", go, title=mark.name, kind=Kind.BOOKMARK)
    yield from scene.commands(ui)
