"""Whatever fails while the window is open."""

from __future__ import annotations

import threading
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.driver import Driver
from viewer.services import scene_loader
from viewer.util.resources import embedded_scenes
from viewer.window import menus
from viewer.window.panels import dialogs, plots, statistics, status


def failing(d: Driver) -> None:
    """Whatever fails, in drawing, a panel, a menu, a command or a thread, is a notice; the window lives on."""
    notices, guard, display = d.c.notices, d.ui.guard, d.ui.graphics.display
    again = f"{icons.ICON_FA_ROTATE_RIGHT}  Try again"

    def fail(*_: object) -> None:
        raise ZeroDivisionError("made to fail")

    def noticed(about: str, times: int = 1) -> None:
        """There is a notice, of one failure only, with all that is known."""
        d.wait(lambda: notices.newest_fault is not None, f"a notice about {about}", 20.0)
        d.frames(8)  # a flood would be counted by now
        notice = notices.newest_fault
        assert about in notice.text and "made to fail" in notice.text and "Traceback" in notice.details, notice
        assert notice.count == times and len([e for e in notices.entries() if e.text == notice.text]) == 1
        assert d.c.frame is not None
        notices.mark_read()

    # Drawing: the picture stays what it was, is not tried again until it should be another, and is not saved as one.
    before, frame = d.shown(), d.c.frame
    with patch.object(display, "write", fail):
        d.press("5")
        noticed("Drawing the picture")
        assert np.array_equal(d.shown(), before)
        d.press("F12")
        assert not d.pictures.exists() and "no picture to save" in d.said
        notices.mark_read()
    d.press("6")
    d.expect_picture()
    assert d.c.frame is frame
    with patch.dict(display.context.info, GL_MAX_TEXTURE_SIZE=16):
        d.fix_resolution(120, 90)
        d.settle()
        assert "120 x 90 is too large for this GPU" in notices.newest_fault.text
    d.c.session.set_pace(fixed_size=False)
    d.settle()
    assert display.picture.size == (d.c.frame.width, d.c.frame.height)
    notices.mark_read()

    # Panels, with tables, children and plots open: one says what is wrong with it, and is shown again when told to.
    for label, module, name in (("Statistics", statistics, "right"), ("Plots", plots, "_stack")):
        d.show_panel(label)
        with patch.object(module, name, fail):
            noticed(f"The panel {label}")
            assert f"The panel {label}" in guard.broken
            d.click(f"//{label}/{icons.ICON_FA_COPY}  Copy details")
            assert imgui.get_clipboard_text() == guard.broken[f"The panel {label}"].as_text
            d.click(f"//{label}/{again}")
            noticed(f"The panel {label}", 2)
        d.click(f"//{label}/{again}")
        assert not guard.broken

    # Bars, dialogs and commands.
    for module, name, part in ((menus, "show", "The menus"), (status, "_summary", "The status bar")):
        with patch.object(module, name, fail):
            noticed(part)
        assert part in guard.broken
        guard.again(part)
        d.frames(3)
        assert not guard.broken
    with patch.object(dialogs, "_line", fail):
        d.press("Ctrl+O")
        noticed(dialogs.OPEN)
        assert not d.ui.dialogs
    d.ui.commands = [replace(c, run=fail) if c.name == "Depth" else c for c in d.ui.commands]
    d.press("5")
    noticed("The command Depth")
    d.choose("View/Depth")
    noticed("The command Depth", 2)

    # Threads.
    threading.Thread(target=fail, name="some thread").start()
    noticed("some thread")
    with patch.object(d.c.renderer._renderer, "refine", fail):
        d.press("T")
        noticed("frame not traced")
    d.press("T").settle()
    with patch.object(scene_loader, "load_visible_scene", fail):
        d.drop(embedded_scenes()["figure4"])
        noticed("Loading figure4.aff failed")

    # All of it is in the log, with what the status bar has said.
    d.show_panel("Log")
    texts = [e.text for e in notices.entries()]
    assert sum("made to fail" in t for t in texts) >= 10 and any("opened in" in t for t in texts)
    d.click(f"//Log/{icons.ICON_FA_COPY}  Copy all")
    assert all(t in imgui.get_clipboard_text() for t in texts)
    d.click("//Log/Clear")
    assert not notices.entries()
