"""Where the window is while it is neither full nor maximised, and that some screen shows it.

Screens come and go, and change their sizes; not every desktop brings back the windows that were there.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from imgui_bundle import glfw_utils  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

Rect = tuple[int, int, int, int]
"""Left, top, width, height."""

EVERY = 1.0
"""Seconds from look to look: the desktop takes time to answer, and to put windows elsewhere by itself."""
GRIP = (120, 24)
"""Of a window's upper edge, so much must be seen for it to be taken hold of."""
SETTLED = 4  # frames of a new window until it and its panels have taken their places


def screens() -> list[Rect]:
    """What screens leave to windows; needs a window."""
    return [glfw.get_monitor_workarea(monitor) for monitor in glfw.get_monitors()]


def shared(a: Rect, b: Rect) -> int:
    """The area that two have in common."""
    across = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    down = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    return max(across, 0) * max(down, 0)


def brought_back(place: Rect, areas: Sequence[Rect], frame: Rect = (0, 0, 0, 0)) -> Rect:
    """Where a window should be: where it is, unless it cannot be taken hold of or more than half of it is on no screen;
    then wholly on the nearest.  `frame` is how wide the desktop's frame is on the left, above, on the right, below."""
    left, top, width, height = place
    grip = left, top, width, GRIP[1]
    held = any(shared(grip, area) >= min(GRIP[0], width) * GRIP[1] for area in areas)
    if not areas or (held and 2 * sum(shared(place, area) for area in areas) >= width * height):
        return place
    x, y, across, down = min(areas, key=lambda area: (-shared(place, area), _distance(place, area)))
    across, down = across - frame[0] - frame[2], down - frame[1] - frame[3]
    x, y = x + frame[0], y + frame[1]
    width, height = min(width, across), min(height, down)
    return min(max(left, x), x + across - width), min(max(top, y), y + down - height), width, height


def _distance(place: Rect, area: Rect) -> int:
    return abs(2 * (place[0] - area[0]) + place[2] - area[2]) + abs(2 * (place[1] - area[1]) + place[3] - area[3])


class Place:
    """`normal` is where the window is or, while it is full, maximised or minimised, was before; None until that is
    known."""

    def __init__(self, areas: Callable[[], list[Rect]] = screens, clock: Callable[[], float] = time.monotonic) -> None:
        self.normal: Rect | None = None
        self._areas, self._clock = areas, clock
        self._looked = -EVERY
        self._seen: list[Rect] | None = None
        self._fits = False  # whether that was made sure since the screens changed

    def new_window(self) -> None:
        """Another window has come, which may be anywhere."""
        self._fits, self._looked = False, self._clock()

    def due(self) -> bool:
        """Whether it is time to look again."""
        now = self._clock()
        if now - self._looked < EVERY:
            return False
        self._looked = now
        return True

    def follow(self, window: Any) -> None:
        """Note where the window is, and bring it back when screens have changed, once they and it are at rest."""
        areas = self._areas()
        changed, self._seen = areas != self._seen, areas
        if changed:
            self._fits = False
        if not is_normal(window):
            return
        place = place_of(window)
        if not changed and not self._fits:
            self._fits = True
            wanted = brought_back(place, areas, glfw.get_window_frame_size(window))
            if wanted != place:
                glfw.set_window_size(window, *wanted[2:])
                glfw.set_window_pos(window, *wanted[:2])
            place = wanted
        self.normal = place


def is_normal(window: Any) -> bool:
    """Whether a window has a size and place of its own now."""
    full = bool(glfw.get_window_monitor(window))
    return not full and not any(glfw.get_window_attrib(window, state) for state in (glfw.ICONIFIED, glfw.MAXIMIZED))


def place_of(window: Any) -> Rect:
    """Where a window is, without the desktop's frame around it."""
    return (*glfw.get_window_pos(window), *glfw.get_window_size(window))


def in_front(window: Any) -> bool:
    """Whether what is typed goes to this window."""
    return bool(glfw.get_window_attrib(window, glfw.FOCUSED))
