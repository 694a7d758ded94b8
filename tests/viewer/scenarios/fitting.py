"""Text and widgets fit into what they lie in."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from imgui_bundle import imgui

from tests.sweeps import cases
from tests.viewer.driver import Driver
from viewer.window.layout import SIDES

_VERTEX = np.dtype([("at", np.float32, 2), ("uv", np.float32, 2), ("color", np.uint32)])


def fitting(d: Driver) -> None:
    """No text is cut off at the edge of what it lies in, and no widget lies over another, at any size."""
    d.pick()
    usual = (("certified", (1280, 800)), ("paper", (1000, 640)))
    for method, size in cases(usual, (("certified", (1600, 1000)), *usual)):
        d.c.settings.change(method=method)
        d.resize(*size).settle()
        _check_panels(d, size)


def _check_panels(d: Driver, size: tuple[int, int]) -> None:
    for label in SIDES:
        d.show_panel(label)
        check_fit(d, f"{label} at {size}")
    d.show_panel("Plots")
    # Frames of which the last has a tick of its own, on the plots' edge.
    for count in cases((1001,), (1, 11, 101, 1001)):
        d.c.history.frames = count
        d.frames(3)
        check_fit(d, f"Plots of {count} frames at {size}")


def check_fit(d: Driver, where: str) -> None:
    """Nothing of what the window shows now is cut off, or wider than it may be."""
    letters, cut = _cut_text()
    assert letters > 100, f"{where}: only {letters} letters are seen"
    assert not cut, f"{where}: text is cut off: {cut}"
    too_wide = []
    for window in _windows():
        over = window.content_size_ideal.x - (window.inner_rect.max.x - window.inner_rect.min.x)
        if over > 1.0 and not window.flags & int(imgui.WindowFlags_.horizontal_scrollbar):
            too_wide.append(f"{window.name}: {over:.0f} pixels")
    assert not too_wide, f"{where}: content is wider than its window: {too_wide}"


def _windows() -> list[Any]:
    """All windows that were drawn in the last frame, but for the dock's, whose tabs scroll, and the test engine's."""
    context, skipped = imgui.get_current_context(), ("MainDockSpace", "Dear ImGui Test Engine")
    return [w for w in context.windows if w.was_active and not w.hidden and not w.name.startswith(skipped)]


def _cut_text() -> tuple[int, list[str]]:
    """How many letters are drawn; and where those are, and in which window, that the left or right edge of what they
    are drawn in cuts."""
    number, cut = 0, []
    for window in _windows():
        draw = window.draw_list
        vertices = _copied(draw.vtx_buffer, _VERTEX)
        indices = _copied(draw.idx_buffer, np.dtype(f"u{imgui.INDEX_SIZE}"))
        for n in range(draw.cmd_buffer.size()):
            command = draw.cmd_buffer[n]
            used = indices[command.idx_offset :][: command.elem_count].astype(int) + command.vtx_offset
            first = used[: max(len(used) - 5, 0)]
            after = np.stack([used[k : k + len(first)] - first for k in range(6)], axis=1)
            begins = first[(after == (0, 1, 2, 0, 2, 3)).all(axis=1)]  # rectangles, letters among them
            low, high = vertices[begins], vertices[begins + 2]
            texels, size = high["uv"] - low["uv"], high["at"] - low["at"]
            letters = (texels > 0.0).all(axis=1) & (size > 1.0).all(axis=1) & (size < 40.0).all(axis=1)
            left, right = low["at"][:, 0], high["at"][:, 0]
            inside = (left < command.clip_rect.z) & (right > command.clip_rect.x)
            seen = (high["at"][:, 1] > command.clip_rect.y) & (low["at"][:, 1] < command.clip_rect.w)
            number += int((letters & inside & seen).sum())
            if window.scroll_max.x > 0.0:
                continue  # what scrolls sideways is cut at its edge
            over = (left < command.clip_rect.x - 1.0) | (right > command.clip_rect.z + 1.0)
            cut += [f"{window.name} {at}" for at in low["at"][letters & inside & seen & over].astype(int).tolist()]
    return number, cut


def _copied(buffer: Any, of: np.dtype) -> np.ndarray:
    """What a buffer of ImGui's holds."""
    size = buffer.size() * of.itemsize
    return np.frombuffer(ctypes.string_at(buffer.data_address(), size) if size else b"", of)
