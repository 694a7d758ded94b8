"""A window that is told to end by the system, or by Ctrl-C where it was started, is closed and loses nothing."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_ENDING = ("SIGTERM", "SIGHUP", "SIGINT")


@contextmanager
def closing_by_signals(close: Callable[[], None]) -> Iterator[None]:
    """Until the end of the block the first signal that ends a program calls `close`; the next is as it was before."""
    if threading.current_thread() is not threading.main_thread():  # others may not say what signals do
        yield
        return
    numbers = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]
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
