"""Pictures that leave the window: as a command, larger, to the clipboard and to tev."""

from __future__ import annotations

import os
import stat
from unittest.mock import patch

import numpy as np
from imgui_bundle import imgui

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from viewer.output import capture
from viewer.state.comparison import CompareMode
from viewer.state.draw_options import Curve, Tone
from viewer.state.views import View
from viewer.views.compare import composed
from viewer.window.panels import saving
from viewer.window.ui import CaptureKind, Dialog


def taking(d: Driver) -> None:
    """Each way out of the window, once; what cannot be done is said."""
    d.inside(lambda: imgui.set_clipboard_text("nothing yet"))
    d.press("Ctrl+Alt+C")
    copied = d.inside(imgui.get_clipboard_text)
    assert copied == d.c.pictures.command() and copied.startswith("shadowcull render ")
    d.c.preferences.screenshot_template = "taken.png"
    _nothing_to_save(d)
    _save_as(d)
    _copy(d)
    d.c.preferences.tev = "127.0.0.1:1"
    d.command("Send to tev").run()
    d.settle()
    assert d.c.notices.message.error and "is tev or HDRView open there?" in d.said


def _nothing_to_save(d: Driver) -> None:
    """A view that has no picture is not saved later as another one, nor one that was left before its picture came."""
    for keys in ("F12", "Ctrl+C"):
        d.press("0").settle()
        assert d.c.scheduler.drawn_view is not View.CERTIFICATE
        d.press(keys)
        assert d.ui.capture_wanted is None
        said = d.c.notices.message
        assert said.error and "Paper has nothing for the view Certificates" in said.text
        d.press("1").settle()
    d.ui.capture_wanted = CaptureKind.PICTURE
    d.c.session.set_draw(view=View.DIFFERENCE)
    d.wait(lambda: d.ui.capture_wanted is None, "the picture that was asked for").settle()
    d.see(View.COLOR)
    assert len(list(d.pictures.iterdir())) == 1, "one that comes is waited for"
    d.ui.capture_wanted, d.ui.capture_view = CaptureKind.PICTURE, View.DIFFERENCE
    d.frames(3)
    assert d.ui.capture_wanted is d.ui.capture_view is None and "another view was chosen" in d.said
    assert len(list(d.pictures.iterdir())) == 1


def _save_as(d: Driver) -> None:
    """A picture of twice the size, with a caption, through the dialog."""
    d.fix_resolution(96, 64)
    d.see(View.OCCLUSION)
    d.press("Ctrl+S")
    plan = d.c.pictures.plan
    plan.multiple, plan.samples, plan.legend = 3, 2, True
    plan.caption = "{scene}, frame {frame}, {method}, {width} × {height}"
    d.frames(2)
    assert d.c.pictures.size == (288, 192)
    d.click(f"//{saving.TITLE}/Save").settle()
    assert Dialog.SAVE_AS not in d.ui.dialogs
    (path,) = d.pictures.glob("tiny-occlusion-288x192*")
    height, width, _ = d.read(path.name).shape
    assert str(path) in d.said and width == 288 and height > 192
    d.see(View.COLOR, tone=Tone(1.0, 2.0, Curve.REINHARD))
    plan.multiple, plan.samples, plan.caption = 1, 1, ""
    assert d.c.pictures.save()
    d.settle()
    (path,) = d.pictures.glob("tiny-color-96x64*")
    assert np.array_equal(d.read(path.name), picture(d.c.frame, tone=d.c.session.draw.tone))
    assert capture.read(path).draw.tone == d.c.session.draw.tone


def _copy(d: Driver) -> None:
    """To the clipboard, by a program that pretends to be the desktop's."""
    folder = d.folder / "programs"
    folder.mkdir()
    with patch.dict(os.environ, PATH=str(folder)):
        os.environ.pop("WAYLAND_DISPLAY", None)
        d.press("Ctrl+C")
        assert d.c.notices.message.error and "install xclip" in d.said
        program = folder / "xclip"
        program.write_text(f"#!/bin/sh\n/bin/cat > {d.pictures}/copied.png\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        d.press("Ctrl+C").settle()
        assert "picture copied" in d.said and np.array_equal(d.read("copied.png"), d.shown())
        d.c.comparing.keep()
        d.c.comparing.start(CompareMode.SIDE)
        d.settle().press("Ctrl+C").settle()
    a = d.shown()
    assert np.array_equal(d.read("copied.png"), composed(a, a, CompareMode.SIDE, 0.5, False))
    d.c.comparing.forget()
