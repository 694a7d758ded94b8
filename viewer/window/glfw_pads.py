"""Game pads and space mice as GLFW sees them."""

from __future__ import annotations

import time
from typing import Any

from imgui_bundle import imgui as _imgui  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

from viewer.state.pads import Kind, Pad

EVERY = 0.5
"""Seconds after which something may have been plugged in."""
_BUTTONS = (
    "A", "B", "X", "Y", "left bumper", "right bumper", "back", "start", "guide", "left stick", "right stick",
    "pad up", "pad right", "pad down", "pad left",
)  # fmt: skip
_SPACE_MICE = ("3dconnexion", "spacemouse", "spacenavigator", "space navigator", "spacepilot", "spaceexplorer")


class Pads:
    """Looks what is plugged in now and then, as GLFW takes half a millisecond to say so, and asks what is there how it
    is.  Needs a window."""

    def __init__(self) -> None:
        self._looked = -EVERY
        self._there: list[int] = []

    def read(self) -> list[Pad]:
        """All that are plugged in; other joysticks are left alone."""
        now = time.monotonic()
        if now - self._looked >= EVERY:
            self._looked = now
            self._there = [n for n in range(glfw.JOYSTICK_LAST + 1) if glfw.joystick_present(n)]
        return [pad for pad in map(_pad, self._there) if pad is not None]


def _pad(number: int) -> Pad | None:
    state: Any = glfw.get_gamepad_state(number)
    if state is not None:
        pressed = frozenset(name for name, down in zip(_BUTTONS, state.buttons, strict=False) if down)
        return Pad(_text(glfw.get_gamepad_name(number)), Kind.GAMEPAD, tuple(state.axes), pressed)
    name = _text(glfw.get_joystick_name(number))
    axes, count = glfw.get_joystick_axes(number)
    if count == 6 and any(known in name.lower() for known in _SPACE_MICE):
        return Pad(name, Kind.SPACE_MOUSE, tuple(float(axes[i]) for i in range(count)))
    return None


def _text(name: Any) -> str:
    """GLFW's Python module hands out bytes, or None where the device has just gone."""
    return name.decode(errors="replace") if isinstance(name, bytes) else str(name or "unknown")
