"""Opens windows by whatever OpenGL the display has, and says why where it has none that will do."""

from __future__ import annotations

import ctypes
import time
import warnings
from collections.abc import Callable
from typing import Any

from imgui_bundle import glfw_utils  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

NEEDED = (3, 3)
NO_OPENGL = (
    "no window can be opened, as this display gives no OpenGL 3.3{instead}; without one, use: shadowcull render SCENE "
    "-o out.png"
)
PATIENCE = 15.0
"""Seconds for a driver that was reset to come back."""
_EVERY = 0.5
_GL_RENDERER, _GL_VERSION = 0x1F01, 0x1F02


def open_window(run: Callable[[], None], is_open: Callable[[], bool], patience: float = 0.0) -> None:
    """Run a window until it is closed, with a context that tells of its loss where the driver knows how; wait so many
    seconds for OpenGL to be there.  Raises OSError, in one line, where the display has none for it."""
    end = time.monotonic() + patience
    while patience and not _gives_window(robust=True) and time.monotonic() < end:
        time.sleep(_EVERY)
    _ask_for(robust=True)
    try:
        run()
        return
    except RuntimeError as error:
        if is_open():
            raise
        if not _gives_window(robust=False):  # Hello ImGui would say on standard error, once more, that it failed
            raise OSError(NO_OPENGL.format(instead=_instead())) from error
    _ask_for(robust=False)
    try:
        run()
    except RuntimeError as error:
        if is_open():
            raise
        raise OSError(NO_OPENGL.format(instead="")) from error


def _ask_for(robust: bool) -> bool:
    """Set what the next window's context is asked for; whether there is a display.  Drivers without contexts that tell
    of their loss give ordinary ones."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", glfw.GLFWError)
        if not glfw.init():
            return False
        glfw.default_window_hints()
        glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.LOSE_CONTEXT_ON_RESET if robust else glfw.NO_ROBUSTNESS)
    return True


def _gives_window(robust: bool) -> bool:
    """Whether a window with the OpenGL that is needed can be made."""
    if not _ask_for(robust):
        return False
    glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, NEEDED[0])
    glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, NEEDED[1])
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)
    window = _hidden_window()
    if window:
        glfw.destroy_window(window)
    return bool(window)


def _hidden_window() -> Any:
    glfw.window_hint(glfw.VISIBLE, False)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", glfw.GLFWError)
        return glfw.create_window(64, 64, "", None, None) or None


def _instead() -> str:
    """What the display does give, as a half-sentence after a comma; "" where that is nothing."""
    if not _ask_for(robust=False):
        return ""
    window = _hidden_window()
    if window is None:
        return ""
    glfw.make_context_current(window)
    try:
        address = glfw.get_proc_address("glGetString")
        if not address:
            return ""
        prototype: Any = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_uint)
        get_string = prototype(address)
        version, by = ((get_string(name) or b"").decode(errors="replace") for name in (_GL_VERSION, _GL_RENDERER))
        return f", but {version} by {by}" if version else ""
    finally:
        glfw.make_context_current(None)  # type: ignore[arg-type]
        glfw.destroy_window(window)
