"""Pictures that leave the window: as a command, larger, with drawings, to the clipboard and to tev."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import numpy as np
from imgui_bundle import imgui
from PIL import Image

from tests.viewer.driver import Driver
from viewer.output import capture
from viewer.output.annotations import annotated
from viewer.output.compared import composed
from viewer.output.pictures import picture
from viewer.output.recipe import from_json
from viewer.state.annotations import Kind
from viewer.state.comparison import Way
from viewer.state.tone import Curve, Tone
from viewer.state.views import View
from viewer.window.panels import save_as
from viewer.window.ui import CaptureKind

KEY = imgui.Key
CTRL, ALT = int(KEY.mod_ctrl), int(KEY.mod_alt)


def taking(d: Driver) -> None:
    """Each way out of the window, once; what cannot be done is said."""
    d.settle()
    copied: list[str] = []
    d._in_frame.append(lambda: imgui.set_clipboard_text("nothing yet"))
    d.frames(2)
    d.press(int(KEY.c) | CTRL | ALT)
    d._in_frame.append(lambda: copied.append(imgui.get_clipboard_text()))
    d.wait(lambda: bool(copied), "the clipboard")
    assert copied[0] == d.c.recipes.command() and copied[0].startswith("shadowcull render ")

    camera = d.c.session.camera
    left, top, right, bottom = d.picture_edges()
    width, height = right - left, bottom - top
    next(c for c in d.ui.commands if c.name == "Draw an arrow").run()
    d.drag((left + 0.5 * width, top + 0.5 * height), (0.2 * width, 0.1 * height))
    next(c for c in d.ui.commands if c.name == "Draw a box").run()
    d.drag((left + 0.3 * width, top + 0.3 * height), (0.1 * width, 0.1 * height))
    next(c for c in d.ui.commands if c.name == "Write on the picture").run()
    d.context.mouse_move_to_pos((left + 0.2 * width, top + 0.7 * height))
    d.context.mouse_click(0)
    d.frames(3)
    d.context.key_chars("Look here")
    d.press(KEY.enter)
    drawn = d.c.session.annotations
    assert [a.kind for a in drawn] == [Kind.ARROW, Kind.BOX, Kind.TEXT] and drawn[2].text == "Look here"
    assert abs(drawn[0].x1 - 0.7) < 0.02 and abs(drawn[0].y1 - 0.6) < 0.02
    assert d.c.session.camera == camera, "the pointer draws, and does not look around"
    next(c for c in d.ui.commands if c.name == "Undo drawing").run()
    assert len(drawn) == 2
    d.press(KEY.escape)
    assert d.ui.tool is None

    d.c.preferences.screenshot_template = "drawn.png"
    d.press(KEY.f12)
    d.wait(lambda: not d.c.captures.busy, "the picture")
    saved = d.folder / "pictures" / "drawn.png"
    with Image.open(saved) as image:
        assert np.array_equal(np.asarray(image), annotated(d.shown(), drawn))
    recipe = from_json(*capture.read_with_size(saved), capture.read_data(saved)["picture"])
    assert recipe.style.annotations == tuple(drawn)

    _nothing_to_save(d)
    _save_as(d)
    _copy(d)
    d.c.preferences.tev = "127.0.0.1:1"
    next(c for c in d.ui.commands if c.name == "Send to tev").run()
    d.wait(lambda: not d.c.pictures.jobs, "nobody to listen")
    assert d.c.notices.message.error and "is tev or HDRView open there?" in d.c.notices.message.text
    next(c for c in d.ui.commands if c.name == "Clear drawings").run()
    assert not drawn
    d.settle()


def _nothing_to_save(d: Driver) -> None:
    """A view that has no picture is not saved later as another one, nor one that was left before its picture came."""
    before = sorted((d.folder / "pictures").iterdir())
    for keys in (KEY.f12, int(KEY.c) | CTRL):
        d.press(KEY._0)
        d.settle()
        assert d.c.tracing.drawn_view is not View.CERTIFICATE
        d.press(keys)
        d.frames(2)
        assert d.ui.capture_wanted is None
        said = d.c.notices.message
        assert said.error and "Certificates" in said.text and "The method paper makes no certificates" in said.text
        d.press(KEY._1)
        d.settle()
        assert not d.c.captures.busy and not d.c.pictures.jobs
    d.ui.capture_wanted = CaptureKind.PICTURE
    d.c.settings.set_view(View.DIFFERENCE)
    d.wait(lambda: d.ui.capture_wanted is None, "the picture that was asked for")
    d.settle()
    d.c.settings.set_view(View.COLOR)
    d.settle()
    assert len(list((d.folder / "pictures").iterdir())) == len(before) + 1, "one that comes is waited for"
    d.ui.capture_wanted, d.ui.capture_view = CaptureKind.PICTURE, View.DIFFERENCE
    d.frames(3)
    assert d.ui.capture_wanted is d.ui.capture_view is None and "another view was chosen" in d.c.notices.message.text
    assert len(list((d.folder / "pictures").iterdir())) == len(before) + 1


def _save_as(d: Driver) -> None:
    """A picture of twice the size, with a caption, through the dialog."""
    d.fix_resolution(96, 64)
    d.c.settings.set_view(View.OCCLUSION)
    d.settle()
    d.press(int(KEY.s) | CTRL)
    d.frames(3)
    plan = d.c.pictures.plan
    plan.multiple, plan.samples, plan.legend = 3, 2, True
    d.context.item_click(f"//{save_as.TITLE}/**/Usual")
    d.frames(2)
    assert d.c.pictures.size == (288, 192)
    d.context.item_click(f"//{save_as.TITLE}/Save")
    d.wait(lambda: d.c.runs.current is None, "the picture")
    d.settle()
    assert not d.ui.save_as_open
    (path,) = (d.folder / "pictures").glob("tiny-occlusion-288x192*")
    assert str(path) in d.c.notices.message.text
    with Image.open(path) as image:
        assert image.width == 288 and image.height > 192
    d.c.settings.set_view(View.COLOR)
    d.c.session.tone = Tone(1.0, 2.0, Curve.REINHARD)
    d.settle()
    plan.multiple, plan.samples, plan.caption = 1, 1, ""
    assert d.c.pictures.save()
    d.wait(lambda: d.c.runs.current is None, "the toned picture")
    (path,) = (d.folder / "pictures").glob("tiny-color-96x64*")
    with Image.open(path) as image:
        expected = annotated(picture(d.c.frame, tone=d.c.session.tone), d.c.session.annotations)
        assert np.array_equal(np.asarray(image), expected)
    assert capture.read(path).tone == d.c.session.tone


def _copy(d: Driver) -> None:
    """To the clipboard, by a program that pretends to be the desktop's."""
    path, wayland = os.environ["PATH"], os.environ.pop("WAYLAND_DISPLAY", None)
    folder = Path(d.folder) / "programs"
    folder.mkdir()
    try:
        os.environ["PATH"] = str(folder)
        d.press(int(KEY.c) | CTRL)
        d.frames(3)
        assert d.c.notices.message.error and "install xclip" in d.c.notices.message.text
        program = folder / "xclip"
        program.write_text(f"#!/bin/sh\n/bin/cat > {folder}/got.png\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        d.press(int(KEY.c) | CTRL)
        d.wait(lambda: (folder / "got.png").exists() and not d.c.pictures.jobs, "the copy")
        d.frames(2)
        assert "is on the clipboard" in d.c.notices.message.text
        with Image.open(folder / "got.png") as image:
            assert np.array_equal(np.asarray(image), annotated(d.shown(), d.c.session.annotations))
        d.c.comparing.keep()
        d.c.comparing.start(Way.SIDE)
        d.settle()
        d.press(int(KEY.c) | CTRL)
        d.wait(lambda: not d.c.pictures.jobs and d.ui.capture_wanted is None, "the copy of both")
        d.frames(2)
    finally:
        os.environ["PATH"] = path
        if wayland is not None:
            os.environ["WAYLAND_DISPLAY"] = wayland
    with Image.open(folder / "got.png") as image:
        a, b = d.shown(), annotated(d.shown(), d.c.session.annotations)
        assert np.array_equal(np.asarray(image), composed(a, b, Way.SIDE, 0.5, False))
    d.c.comparing.forget()
    d.c.session.tone = Tone()
    d.settle()
