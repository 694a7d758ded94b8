"""What the window is drawn with can be lost: a driver is reset, a graphics processor hangs or is taken away.

Drivers tell those who ask.  All that is lost is a copy of what is in memory, so another window takes the place of this.
"""

from __future__ import annotations

import ctypes
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from imgui_bundle import glfw_utils  # noqa: F401  # brings the GLFW that is imported next  # isort: skip
import glfw  # isort: skip

OFTEN, LATELY = 4, 60.0
"""So many losses in so many seconds are too many to go on."""
_RESET = "the graphics driver was reset"
_CAUSES = {  # by GL_KHR_robustness
    0x8253: f"{_RESET}, as something that the window drew took too long",
    0x8254: f"{_RESET}, as another program made it hang",
}
_ASKED = ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB")


def reset_status() -> Callable[[], int]:
    """What says of the current context whether it is lost: 0 for no."""
    for name in _ASKED:
        address = glfw.get_proc_address(name)
        if address:
            prototype: Any = getattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE)(ctypes.c_uint)
            status: Callable[[], int] = prototype(address)
            return status
    return lambda: 0


class Losses:
    """`cause` says in words why the context is lost; "" while it is not."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.cause = ""
        self.status: Callable[[], int] = lambda: 0
        self._clock = clock
        self._at: deque[float] = deque(maxlen=OFTEN)

    def watch(self) -> None:
        """Look after the context that is current now."""
        self.cause, self.status = "", reset_status()

    def look(self) -> bool:
        """Ask the driver; whether the context is lost."""
        if not self.cause:
            found = self.status()
            if found:
                self._at.append(self._clock())
                self.give_up(_CAUSES.get(found, _RESET))
        return bool(self.cause)

    def give_up(self, cause: str) -> None:
        """Have another window, whatever the driver says."""
        self.cause = cause

    @property
    def too_many(self) -> bool:
        """Whether the driver loses contexts again and again."""
        return len(self._at) == OFTEN and self._at[-1] - self._at[0] < LATELY
