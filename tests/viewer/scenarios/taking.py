"""Pictures that leave the window: as a command, larger, to the clipboard and to tev."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import numpy as np
from imgui_bundle import imgui
from PIL import Image

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from viewer.output import capture
from viewer.state.comparison import CompareMode
from viewer.state.draw_options import Curve, Tone
from viewer.state.views import View
from viewer.views.compare import composed
from viewer.window.panels import saving
from viewer.window.ui import CaptureKind, Dialog

KEY = imgui.Key
CTRL, ALT = int(KEY.mod_ctrl), int(KEY.mod_alt)


def taking(d: Driver) -> None:
    """Each way out of the window, once; what cannot be done is said."""
    d.settle()
    d.inside(lambda: imgui.set_clipboard_text("nothing yet"))
    d.press(int(KEY.c) | CTRL | ALT)
    copied = d.inside(imgui.get_clipboard_text)
    assert copied == d.c.pictures.command() and copied.startswith("shadowcull render ")
    d.c.preferences.screenshot_template = "taken.png"
    d.press(KEY.f12)
    d.wait(lambda: not d.c.captures.busy, "the picture")
    with Image.open(d.folder / "pictures" / "taken.png") as image:
        assert np.array_equal(np.asarray(image), d.shown())
    _nothing_to_save(d)
    _save_as(d)
    _copy(d)
    d.c.preferences.tev = "127.0.0.1:1"
    next(c for c in d.ui.commands if c.name == "Send to tev").run()
    d.wait(lambda: not d.c.captures.busy, "nobody to listen")
    assert d.c.notices.message.error and "is tev or HDRView open there?" in d.said
    d.settle()


def _nothing_to_save(d: Driver) -> None:
    """A view that has no picture is not saved later as another one, nor one that was left before its picture came."""
    before = sorted((d.folder / "pictures").iterdir())
    for keys in (KEY.f12, int(KEY.c) | CTRL):
        d.press(KEY._0)
        d.settle()
        assert d.c.scheduler.drawn_view is not View.CERTIFICATE
        d.press(keys)
        d.frames(2)
        assert d.ui.capture_wanted is None
        said = d.c.notices.message
        assert said.error and "The method paper has nothing for the view Certificates" in said.text
        d.press(KEY._1)
        d.settle()
        assert not d.c.captures.busy
    d.ui.capture_wanted = CaptureKind.PICTURE
    d.c.session.set_draw(view=View.DIFFERENCE)
    d.wait(lambda: d.ui.capture_wanted is None, "the picture that was asked for")
    d.settle()
    d.see(View.COLOR)
    assert len(list((d.folder / "pictures").iterdir())) == len(before) + 1, "one that comes is waited for"
    d.ui.capture_wanted, d.ui.capture_view = CaptureKind.PICTURE, View.DIFFERENCE
    d.frames(3)
    assert d.ui.capture_wanted is d.ui.capture_view is None and "another view was chosen" in d.said
    assert len(list((d.folder / "pictures").iterdir())) == len(before) + 1


def _save_as(d: Driver) -> None:
    """A picture of twice the size, with a caption, through the dialog."""
    d.fix_resolution(96, 64)
    d.see(View.OCCLUSION)
    d.press(int(KEY.s) | CTRL)
    d.frames(3)
    plan = d.c.pictures.plan
    plan.multiple, plan.samples, plan.legend = 3, 2, True
    plan.caption = "{scene}, frame {frame}, {method}, {width} × {height}"
    d.frames(2)
    assert d.c.pictures.size == (288, 192)
    d.click(f"//{saving.TITLE}/Save")
    d.wait(lambda: d.c.runs.current is None, "the picture")
    d.settle()
    assert Dialog.SAVE_AS not in d.ui.dialogs
    (path,) = (d.folder / "pictures").glob("tiny-occlusion-288x192*")
    assert str(path) in d.said
    with Image.open(path) as image:
        assert image.width == 288 and image.height > 192
    d.c.session.set_draw(view=View.COLOR)
    d.c.session.set_draw(tone=Tone(1.0, 2.0, Curve.REINHARD))
    d.settle()
    plan.multiple, plan.samples, plan.caption = 1, 1, ""
    assert d.c.pictures.save()
    d.wait(lambda: d.c.runs.current is None, "the toned picture")
    (path,) = (d.folder / "pictures").glob("tiny-color-96x64*")
    with Image.open(path) as image:
        assert np.array_equal(np.asarray(image), picture(d.c.frame, tone=d.c.session.draw.tone))
    assert capture.read(path).draw.tone == d.c.session.draw.tone


def _copy(d: Driver) -> None:
    """To the clipboard, by a program that pretends to be the desktop's."""
    path, wayland = os.environ["PATH"], os.environ.pop("WAYLAND_DISPLAY", None)
    folder = Path(d.folder) / "programs"
    folder.mkdir()
    try:
        os.environ["PATH"] = str(folder)
        d.press(int(KEY.c) | CTRL)
        d.frames(3)
        assert d.c.notices.message.error and "install xclip" in d.said
        program = folder / "xclip"
        program.write_text(f"#!/bin/sh\n/bin/cat > {folder}/got.png\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        d.press(int(KEY.c) | CTRL)
        d.wait(lambda: (folder / "got.png").exists() and not d.c.captures.busy, "the copy")
        d.frames(2)
        assert "picture copied" in d.said
        with Image.open(folder / "got.png") as image:
            assert np.array_equal(np.asarray(image), d.shown())
        d.c.comparing.keep()
        d.c.comparing.start(CompareMode.SIDE)
        d.settle()
        d.press(int(KEY.c) | CTRL)
        d.wait(lambda: not d.c.captures.busy and d.ui.capture_wanted is None, "the copy of both")
        d.frames(2)
    finally:
        os.environ["PATH"] = path
        if wayland is not None:
            os.environ["WAYLAND_DISPLAY"] = wayland
    with Image.open(folder / "got.png") as image:
        a = d.shown()
        assert np.array_equal(np.asarray(image), composed(a, a, CompareMode.SIDE, 0.5, False))
    d.c.comparing.forget()
    d.c.session.set_draw(tone=Tone())
    d.settle()
