"""Runs each part of the window so that a mistake in one ends neither the window nor the other parts.

An exception that left a callback would end Hello ImGui's loop, and with it the program.  Here it becomes a fault in
the log and a notice, and ImGui's stacks are put back to where they were before the part began.  A panel that failed is
not shown again until the user says so: its place says what went wrong."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui, implot

from viewer.state.notices import Entry, Notices
from viewer.util.messages import failure


class Guard:
    """`broken` holds, by its name, each part that has failed and is not shown for now."""

    def __init__(self, notices: Notices, instead: Callable[[str, Entry], None]) -> None:
        """`instead` draws what stands in the place of a broken part, of which it gets the name and the fault."""
        self._notices = notices
        self._instead = instead
        self.broken: dict[str, Entry] = {}

    def step(self, name: str, work: Callable[[], object]) -> None:
        """Something that is done in each frame before the widgets, or on behalf of the user."""
        try:
            work()
        except Exception as error:
            self._report(name, error)

    def overlay(self, name: str, show: Callable[[], None], close: Callable[[], None] = lambda: None) -> None:
        """Widgets that come and go, such as a dialog: closed when they fail."""
        if self._drawn(name, show) is not None:
            close()

    def panel(self, name: str, show: Callable[[], None]) -> None:
        """Widgets that have a place of their own; not shown again after they failed until `again`."""
        entry = self.broken.get(name)
        if entry is None:
            entry = self._drawn(name, show)
            if entry is not None:
                self.broken[name] = entry
        else:
            self._drawn(f"{name}: saying what went wrong", lambda: self._instead(name, entry))

    def again(self, name: str) -> None:
        """Show this part once more."""
        self.broken.pop(name, None)

    def _drawn(self, name: str, show: Callable[[], None]) -> Entry | None:
        before = imgui.internal.ErrorRecoveryState()
        imgui.internal.error_recovery_store_state(before)
        window = imgui.internal.get_current_window()
        try:
            show()
        except Exception as error:
            _recover(before, window)
            return self._report(name, error)
        return None

    def _report(self, name: str, error: Exception) -> Entry:
        return self._notices.fault(failure(error, f"{name} failed"))


def configure() -> None:
    """Let ImGui repair what it is used wrongly for, and say so on standard error.

    Its assertions would be raised from the middle of its work, and what they leave behind cannot be repaired."""
    io = imgui.get_io()
    io.config_error_recovery = True
    io.config_error_recovery_enable_assert = io.config_error_recovery_enable_tooltip = False
    io.config_error_recovery_enable_debug_log = True


def _recover(before: imgui.internal.ErrorRecoveryState, window: imgui.internal.Window) -> None:
    """End whatever was begun since then, in this window or in others."""
    io = imgui.get_io()
    asserts, logs = io.config_error_recovery_enable_assert, io.config_error_recovery_enable_debug_log
    io.config_error_recovery_enable_assert = io.config_error_recovery_enable_debug_log = False
    in_menu_bar = window.dc.menu_bar_appending
    try:
        window.dc.menu_bar_appending = False  # else the bar would be ended as well, which was begun before
        if implot.internal.get_current_plot() is not None:
            implot.end_plot()
        imgui.internal.error_recovery_try_to_recover_state(before)
        window.dc.menu_bar_appending = in_menu_bar
    finally:
        io.config_error_recovery_enable_assert, io.config_error_recovery_enable_debug_log = asserts, logs
