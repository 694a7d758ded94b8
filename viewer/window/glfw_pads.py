"""Game pads and space mice as GLFW sees them."""

from __future__ import annotations

from typing import Any

from imgui_bundle import imgui as _imgui  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

from viewer.state.pads import Kind, Pad

_BUTTONS = (
    "A", "B", "X", "Y", "left bumper", "right bumper", "back", "start", "guide", "left stick", "right stick",
    "pad up", "pad right", "pad down", "pad left",
)  # fmt: skip
_SPACE_MICE = ("3dconnexion", "spacemouse", "spacenavigator", "space navigator", "spacepilot", "spaceexplorer")


def pads() -> list[Pad]:
    """All that are plugged in now; needs a window.  Other joysticks are left alone."""
    found = []
    for number in range(glfw.JOYSTICK_LAST + 1):
        if not glfw.joystick_present(number):
            continue
        state: Any = glfw.get_gamepad_state(number)
        if state is not None:
            pressed = frozenset(name for name, down in zip(_BUTTONS, state.buttons, strict=False) if down)
            found.append(Pad(_text(glfw.get_gamepad_name(number)), Kind.GAMEPAD, tuple(state.axes), pressed))
            continue
        name = _text(glfw.get_joystick_name(number))
        axes, count = glfw.get_joystick_axes(number)
        if count == 6 and any(known in name.lower() for known in _SPACE_MICE):
            found.append(Pad(name, Kind.SPACE_MOUSE, tuple(float(axes[i]) for i in range(count))))
    return found


def _text(name: Any) -> str:
    """GLFW's Python module hands out bytes, or None where the device has just gone."""
    return name.decode(errors="replace") if isinstance(name, bytes) else str(name or "unknown")
