"""The paper's Figure 1 with the numbers of the newest frame: read, and clicked."""

from __future__ import annotations

from imgui_bundle import imgui

from tests.viewer.driver import Driver
from viewer.output.figure1_drawing import Box, Drawing, Words
from viewer.state.views import View
from viewer.util.resources import embedded_scenes


def figure1(d: Driver) -> None:
    """The figure has the frame's numbers, wherever its panel is, and its parts open the views that show them."""
    d.fix_resolution(320, 220)
    d.open(embedded_scenes()["figure4"])
    d.change(method="paper")
    for _ in range(2):
        d.press("T").settle()
    for _ in d.sizes():
        d.show_panel("Figure 1")
        shadow, changes = d.c.frame.statistics.shadow, d.c.frame.statistics.mode_changes
        assert shadow.saved > 0
        told = " ".join(part.tip for part in _drawing(d).parts if isinstance(part, Box))
        numbers = {"shadow rays due": shadow.due, "culled": shadow.culled, "dynamic only": shadow.dynamic_only,
                   "traced": shadow.traced, "→ fully rendered": changes.fully_rendered}  # fmt: skip
        assert all(f"{name}: {number:,}" in told for name, number in numbers.items()), told
        assert d.panel("Figure 1").scroll_max.y == 0.0, "the figure does not fit its panel"
    for name, view in (("Shadow testing", View.FATE), ("→ examined anew", View.PIXEL_COUNT)):
        _click(d, name)
        assert d.c.session.draw.view is view, name
        d.settle()

    # Without culling it says what modes would do; with certificates these stand in the place of modes.
    d.change(method="none")
    said = {words.text for words in _words(d)}
    assert "would be culled" in said
    d.change(method="certified")
    said = {words.text for words in _words(d)}
    assert "Certificates" in said and not any("mode setting" in text for text in said)
    _click(d, "Certificates")
    assert d.c.session.draw.view is View.CERTIFICATE


def _drawing(d: Driver) -> Drawing:
    """What is drawn of the newest frame."""
    d.frames(3)
    frame, _, drawing = d.ui._cache["figure 1"]
    assert frame is d.c.frame, "the panel is not drawn"
    return drawing


def _words(d: Driver) -> list[Words]:
    return [part for part in _drawing(d).parts if isinstance(part, Words)]


def _click(d: Driver, name: str) -> None:
    """On the part of the figure that has this name, where the panel shows it."""
    scale, words = _drawing(d).scale, next(words for words in _words(d) if words.text.startswith(name))
    window = d.panel("Figure 1")
    imgui.internal.set_scroll_y(window, max(scale * words.y - 0.5 * window.inner_rect.get_height(), 0.0))
    d.frames(3)
    left, top, _, _ = d.place("//Figure 1/figure 1")
    d.move_to(left + scale * words.x + 4.0, top + scale * words.y + 4.0).click_here()
