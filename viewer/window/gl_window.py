"""Opens windows by whatever OpenGL the display has, notices when a window's context is lost, and closes the window on
the signals that end a program.

A context is lost when a driver is reset, or a graphics processor hangs or is taken away.  Drivers tell those who ask.
All that is lost is a copy of what is in memory, so another window takes its place."""

from __future__ import annotations

import ctypes
import signal
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from imgui_bundle import glfw_utils  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

NEEDED = (3, 3)
NO_OPENGL = (
    "no window can be opened, as this display gives no OpenGL 3.3; without one, use: shadowcull render SCENE -o out.png"
)
PATIENCE = 15.0
"""Seconds for a driver that was reset to come back."""
RETRY_SECONDS = 0.5
MOST_LOSSES, LOSS_SECONDS = 4, 60.0
"""So many losses in so many seconds are too many to go on."""
_RESET = "the graphics driver was reset"
_CAUSES = {  # by GL_KHR_robustness
    0x8253: f"{_RESET}, as something that the window drew took too long",
    0x8254: f"{_RESET}, as another program made it hang",
}
_STATUS_FUNCTIONS = ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB")
_SIGNALS = ("SIGTERM", "SIGHUP", "SIGINT")


def open_window(run: Callable[[], None], is_open: Callable[[], bool], patience: float = 0.0) -> None:
    """Run a window until it is closed, with a context that tells of its loss where the driver knows how; wait so many
    seconds for OpenGL to be there.  Raises OSError, in one line, where the display has none for it."""
    end = time.monotonic() + patience
    while patience and not _gives_window(robust=True) and time.monotonic() < end:
        time.sleep(RETRY_SECONDS)
    _set_context_hints(robust=True)
    try:
        run()
        return
    except RuntimeError as error:
        if is_open():
            raise
        if not _gives_window(robust=False):  # Hello ImGui would say on standard error, once more, that it failed
            raise OSError(NO_OPENGL) from error
    _set_context_hints(robust=False)
    try:
        run()
    except RuntimeError as error:
        if is_open():
            raise
        raise OSError(NO_OPENGL) from error


def _set_context_hints(robust: bool) -> bool:
    """Set what the next window's context is asked for; returns whether there is a display.  Drivers without contexts
    that tell of their loss give ordinary ones."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", glfw.GLFWError)
        if not glfw.init():
            return False
        glfw.default_window_hints()
        glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.LOSE_CONTEXT_ON_RESET if robust else glfw.NO_ROBUSTNESS)
    return True


def _gives_window(robust: bool) -> bool:
    """Return whether a window with the OpenGL that is needed can be made."""
    if not _set_context_hints(robust):
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


def _reset_status() -> Callable[[], int]:
    """Return the function that says whether the current context is lost: 0 for no."""
    for name in _STATUS_FUNCTIONS:
        address = glfw.get_proc_address(name)
        if address:
            prototype: Any = getattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE)(ctypes.c_uint)
            status: Callable[[], int] = prototype(address)
            return status
    return lambda: 0


class ContextLoss:
    """Watches a context; `cause` says in words why it is lost, "" while it is not."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.cause = ""
        self.status: Callable[[], int] = lambda: 0
        self._clock = clock
        self._at: deque[float] = deque(maxlen=MOST_LOSSES)

    def watch(self) -> None:
        """Watch the context that is current now."""
        self.cause, self.status = "", _reset_status()

    def is_lost(self) -> bool:
        """Ask the driver whether the context is lost."""
        if not self.cause:
            found = self.status()
            if found:
                self._at.append(self._clock())
                self.cause = _CAUSES.get(found, _RESET)
        return bool(self.cause)

    @property
    def too_many(self) -> bool:
        """Whether the driver loses contexts again and again."""
        return len(self._at) == MOST_LOSSES and self._at[-1] - self._at[0] < LOSS_SECONDS


@contextmanager
def closing_by_signals(close: Callable[[], None]) -> Iterator[None]:
    """Let the first signal that ends a program call `close` until the end of the block; the next is as it was before,
    so that a window that does not close can still be killed."""
    if threading.current_thread() is not threading.main_thread():  # others may not say what signals do
        yield
        return
    numbers = [getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)]
    before: dict[int, Any] = {}

    def restore() -> None:
        while before:
            signal.signal(*before.popitem())

    def closing(_number: int, _frame: Any) -> None:
        restore()
        close()

    before |= {number: signal.signal(number, closing) for number in numbers}
    try:
        yield
    finally:
        restore()
