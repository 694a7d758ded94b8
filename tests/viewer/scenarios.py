"""What a user does in the window, and what must come of it.  Each function is run by `tests.viewer.window`."""

from __future__ import annotations

import json
import math
import threading
import time
from dataclasses import replace
from pathlib import Path

import glfw
import numpy as np
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.window import Driver
from tracer.renderer import Renderer
from viewer import commands, opening
from viewer.commands import chord
from viewer.explaining import Part
from viewer.legends import occlusion_legend
from viewer.panels import browser, plots, statistics, status
from viewer.pictures import picture
from viewer.resources import embedded_scenes
from viewer.views import WRONG, View, wipe_column

KEY = imgui.Key


def views(d: Driver) -> None:
    """Every view by its key, each the same as what the command line would draw; only what must be verified, or
    counted, is traced for, once, and as little for the views after it."""
    d.c.change(method="paper")
    d.settle()
    d.certify()
    d.press(KEY.t)
    d.settle()
    traced = d.c.history.frames
    d.c.preferences.shading = 0.35
    for view in View:
        before = d.c.history.frames
        d.press(chord(view.key))
        assert d.c.session.view is view
        assert view.needs_verify or view.needs_work or d.c.history.frames == before, "changing the view has traced"
        d.settle()
        shown = d.shown().astype(int)
        expected = picture(d.c.frame, view, d.c.session.light).astype(int)
        difference = np.abs(shown - expected)
        assert difference.max() <= 2, f"{view}: off by {difference.max()} at {np.argwhere(difference > 2)[:3]}"
    d.press(KEY._3)
    d.press(KEY.l)
    assert d.c.session.light == 1
    d.press(int(KEY.l) | int(KEY.mod_shift))
    assert d.c.session.light == 0
    d.press(KEY.h)
    d.press(KEY.u)
    for view in (View.SAVED, View.COST):
        d.c.set_view(view)
        d.frames(2)
        expected = picture(d.c.frame, view, shares=True).astype(int)
        assert np.abs(d.shown().astype(int) - expected).max() <= 2
        assert np.abs(expected - picture(d.c.frame, view)).max() > 20
    d.settle()
    assert d.c.history.frames == traced + 2, "only the first of the views that verify traces, and of those that count"
    assert not d.c.session.settings.verify and not d.c.preferences.verify


def _figure4(d: Driver, frame: int) -> None:
    """The paper's Figure 4 up to a frame, as it is described there: 128 x 128 pixels, frame by frame."""
    p = d.c.preferences
    p.dynamic_resolution, p.fixed_resolution, p.fixed_width, p.fixed_height = False, True, 128, 128
    p.every_frame = p.loop = False
    d.c.change(method="paper")
    d.drop(embedded_scenes()["figure4"])
    d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the scene of Figure 4")
    d.settle()
    for number in range(1, frame + 1):
        d.press(KEY.right_arrow)
        d.settle()
        assert d.c.session.frame == number


def difference(d: Driver) -> None:
    """The dimmed picture where all is right; where culling misses a shadow, one colour, counted, and ringed where that
    is wanted."""
    of_wrong = np.round(np.multiply(255.0, WRONG))

    def dimmed() -> np.ndarray:
        return d.c.preferences.beneath * picture(d.c.frame).astype(float)

    d.settle()
    d.press(KEY._8)
    d.settle()
    assert d.c.frame.wrong is not None and not d.c.frame.wrong.any()
    assert np.abs(d.shown() - dimmed()).max() <= 1, "nothing is wrong, yet something shines"
    d.press(KEY._1)
    _figure4(d, 20)
    assert d.c.frame.wrong is None, "verified, though no view asks for it"
    d.press(KEY._8)
    d.settle()
    wrong = d.c.frame.wrong > 0
    assert d.c.frame.statistics.shadow.wrong == d.c.frame.wrong.sum() > 0
    marked = d.shown()
    assert np.array_equal((marked == of_wrong).all(axis=-1), wrong)
    assert np.count_nonzero(np.abs(marked - dimmed()).max(axis=-1) > 1) > np.count_nonzero(wrong), "no rings"
    d.press(KEY.m)
    assert not d.c.preferences.mark_wrong
    assert np.abs(d.shown() - dimmed())[~wrong].max() <= 1, "the picture, dimmed, where every answer is right"
    d.c.preferences.beneath = 0.0
    d.frames(2)
    assert np.array_equal(d.shown().any(axis=-1), wrong), "black beneath, if so chosen"
    d.c.preferences.beneath = 0.5
    d.press(KEY.m)
    y, x = np.argwhere(wrong)[0]
    d.c.select(((x + 0.5) / 128, (y + 0.5) / 128))
    d.frames(3)
    assert d.c.selected.wrong == d.c.frame.wrong[y, x] > 0
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none" and not d.c.frame.wrong.any()
    d.c.selected = None
    d.frames(3)
    assert np.abs(d.shown() - dimmed()).max() <= 1
    assert not d.c.session.settings.verify


def wiping(d: Driver) -> None:
    """The line of the wipe is dragged by the pointer and nothing else moves; elsewhere a drag turns the camera."""
    d.settle()
    _figure4(d, 20)
    d.c.preferences.mark_wrong = False
    d.press(KEY._9)
    d.settle()
    frame = d.c.frame
    assert (frame.color != frame.reference).any()
    left, top, right, bottom = d.picture_edges()
    camera, pivot, middle = d.c.session.camera, d.ui.pivot, (top + bottom) / 2.0

    def drag_line(start: float, end: float, height: float) -> None:
        x = left + start * (right - left)
        d.drag((x, height), ((end - start) * (right - left), 7.0))
        assert abs(d.c.session.wipe - end) < 0.02
        assert d.c.session.camera == camera and d.ui.pivot is pivot and d.c.selected is None

    drag_line(0.5, 0.3, middle)
    assert np.abs(d.shown().astype(int) - picture(frame, View.WIPE, marked=False, wipe=d.c.session.wipe)).max() <= 1
    drag_line(0.3, 0.9, top + 0.2 * (bottom - top))
    pixels, column = d.shown(), wipe_column(128, d.c.session.wipe)
    assert np.array_equal(pixels[:, :column], picture(frame)[:, :column]), "left of the line is the traced picture"
    x = left + d.c.session.wipe * (right - left)
    d.drag((x, middle), (2.0 * (right - left), 0.0))
    assert d.c.session.wipe == 1.0, "past the edge it stays on it"
    d.drag((right - 1.0, middle), (-(right - left) - 30.0, 0.0))
    assert d.c.session.wipe == 0.0
    pixels = d.shown()
    right_one = picture(replace(frame, color=frame.reference))
    assert np.array_equal(pixels[:, 1:], right_one[:, 1:]), "right of the line is the reference"
    assert d.c.frame is frame and d.c.session.camera == camera, "dragging the line has traced"
    traced = d.c.history.frames
    d.drag((left + 0.7 * (right - left), middle), (60.0, 0.0))
    assert d.c.session.wipe == 0.0 and d.c.session.camera != camera, "elsewhere a drag turns the camera"
    d.settle()
    assert d.c.history.frames > traced and d.c.frame.settings.verify
    d.c.session.wipe = 0.5
    camera = d.c.session.camera
    x = (left + right) / 2.0
    d.drag((x, middle), (90.0, 0.0), 1)
    assert d.c.session.wipe == 0.5 and d.c.session.camera != camera, "only the left button takes the line"
    d.settle()


def culling(d: Driver) -> None:
    """Tracing again culls; the key switches it off and on; resetting forgets."""
    d.c.change(method="paper")
    d.settle()
    first = d.c.frame.statistics.shadow
    assert first.due > 0 and first.culled == 0
    d.press(KEY.t)
    d.settle()
    second = d.c.frame.statistics.shadow
    assert second.culled + second.dynamic_only > 0
    assert second.due == first.due
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none" and d.c.frame.statistics.shadow.culled == 0
    d.press(KEY.c)
    d.settle()
    d.press(KEY.backspace)
    d.settle()
    assert d.c.frame.statistics.shadow.culled == 0
    d.context.item_click("//Culling/Symmetric occlusion test")
    d.settle()
    assert d.c.frame.settings.symmetric


def certifying(d: Driver) -> None:
    """Modes are there at once whatever culls; where a view has nothing to show, a note says so and a button switches;
    a method is chosen with what it takes along; key C is off."""
    d.settle()
    d.wait(lambda: d.c.opener.certifies, "the kernels that make certificates")
    for base in ("certified", "none"):
        d.c.change(method=base)
        d.settle()
        traced = d.c.history.frames
        for key, view in ((KEY._2, View.OCCLUSION), (KEY._3, View.SHADOW), (KEY._7, View.PIXEL_COUNT)):
            d.press(key)
            assert d.c.tracing.drawn_view is view and d.c.history.frames == traced
            assert np.abs(d.shown().astype(int) - picture(d.c.frame, view, d.c.session.light)).max() <= 2
        seen = [row.name for row in occlusion_legend(d.c.frame) if row.pixels]
        assert "FULLY_RENDERED" in seen, seen
        said = d.c.frame.statistics.by_modes_in_all
        assert said.full_shadow + said.non_shadow > 0
        d.press(KEY._8)
        d.settle()
        d.context.item_click("//Picture/**/Use paper##instead")
        d.settle()
        assert d.c.frame.settings.method == "paper"
    d.press(KEY._0)
    assert d.c.session.view is View.CERTIFICATE and d.c.frame.certificates is None
    assert d.c.tracing.drawn_view is View.COLOR
    d.certify()
    d.context.item_click("//Picture/**/Use certified##instead")
    d.settle()
    assert d.c.frame.settings.method == "certified" and d.c.tracing.drawn_view is View.CERTIFICATE
    d.context.menu_click("//##MainMenuBar/Culling/Method certified")
    d.context.item_click("//Culling/+cache")
    d.settle()
    assert d.c.frame.settings.method == "certified+cache" == d.c.preferences.method
    assert d.c.frame.certificates is not None
    expected = picture(d.c.frame, View.CERTIFICATE, shading=d.c.preferences.shading)
    assert np.abs(d.shown().astype(int) - expected).max() <= 2
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none"
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "certified+cache"
    for key in ("H", "Shift+H"):
        d.press(chord(key))
        d.settle()
        assert d.c.tracing.drawn_view is d.c.session.view and not d.c.tracing.outdated


def explaining(d: Driver) -> None:
    """What the pointer is on, or was clicked, is explained beside the window's own frames; a key hides the lines."""
    d.settle()
    explaining = d.c.explaining
    assert explaining.answer is None
    traced = d.c.history.frames
    left, top, right, bottom = d.picture_edges()
    shadow, lit = (_places(d, lit) for lit in (False, True))
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.wait(lambda: explaining.answer is not None, "an answer about the pointer's pixel", 20.0)
    blocked = [one for one in explaining.answer.lights if one.blocked_at is not None]
    assert blocked and all(one.due and not one.lit for one in blocked)
    d.frames(3)
    hovering = _lines_drawn(d)
    d.press(KEY.i)
    assert _lines_drawn(d) == hovering, "shadow rays are drawn for a pixel that was not clicked"
    d.press(KEY.i)
    lines = explaining.lines(d.c.frame)
    assert {line.part for line in lines} >= {Part.BLOCKER, Part.REACHING, Part.STOPPED}
    d.context.mouse_move_to_pos((left + lit[0] * (right - left), top + lit[1] * (bottom - top)))
    d.wait(lambda: all(one.lit for one in explaining.answer.lights if one.due), "an answer about another pixel", 20.0)
    parts = {line.part for line in explaining.lines(d.c.frame)}
    assert Part.REACHING in parts and not parts & {Part.STOPPED, Part.BLOCKER}  # candidates there may be
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selected is not None
    d.context.mouse_move_to_pos((left + lit[0] * (right - left), top + lit[1] * (bottom - top)))
    d.wait(lambda: explaining.answer is not None, "an answer about what was clicked", 20.0)
    assert any(one.blocked_at is not None for one in explaining.answer.lights), "it goes on following the pointer"
    assert d.c.history.frames == traced, "asking has traced a frame"
    point = explaining.answer.lights[0].point
    d.hold(KEY.d, 0.3)
    d.settle()
    assert explaining.answer is not None and math.dist(explaining.answer.lights[0].point, point) < 0.2
    d.context.mouse_move(f"//Inspector/**/{d.c.session.scene.lights[0].name}##light")
    d.frames(3)
    assert d.ui.pointed_light == 0
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.frames(3)
    drawn = _lines_drawn(d)
    d.press(KEY.i)
    assert not d.c.preferences.draw_explanation and _lines_drawn(d) < drawn - 50
    d.press(KEY.i)
    assert _lines_drawn(d) == drawn
    d.press(KEY.escape)
    assert d.c.selected is None and _lines_drawn(d) < drawn - 50, "Escape clears"
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selected is not None
    d.context.mouse_move_to_pos((left + 0.5 * (right - left), top + 0.02 * (bottom - top)))
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selected is None and explaining.answer is None, "a click on nothing clears"


def _lines_drawn(d: Driver) -> int:
    """How much is drawn over the picture, in corners of triangles."""
    return imgui.internal.find_window_by_name("Picture").draw_list.vtx_buffer.size()


def _places(d: Driver, lit: bool) -> tuple[float, float]:
    """A pixel of the square, on the picture, that a light which is due reaches, or does not, and so its neighbours."""
    renderer = Renderer(d.c.session.scene, replace(d.c.frame.settings, method="none", record_lights=True))
    frame = renderer.render(d.c.frame.time, d.c.frame.camera)
    here = (frame.primitive >= 0) & (frame.primitive < d.c.session.scene.triangle_count)
    here &= (frame.lit == frame.due).all(-1) if lit else (frame.due & ~frame.lit).any(-1)
    inner = here.copy()
    for shift in (-4, 4):
        inner &= np.roll(here, shift, 0) & np.roll(here, shift, 1)
    y, x = np.argwhere(inner)[inner.sum() // 2]
    return (x + 0.5) / frame.width, (y + 0.5) / frame.height


def flying(d: Driver) -> None:
    """Keys and drags on the picture move the camera; typing and drags on panels do not."""
    d.settle()
    home = d.c.session.camera
    d.hold(KEY.w, 0.3)
    ahead = d.c.session.camera
    assert np.dot(np.subtract(ahead.position, home.position), home.basis()[2]) > 0.0
    assert ahead.basis()[2] @ home.basis()[2] > 0.999
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.size, "at rest the resolution is the window's"
    assert d.c.traced.request.divisor == 1 and d.c.traced.whole

    before = d.c.session.camera
    d.drag(d.picture_centre(), (80.0, 0.0))
    assert d.c.session.camera.position == before.position
    assert d.c.session.camera.basis()[2] @ before.basis()[0] > 0.05, "dragging right looks right"
    d.drag(d.picture_centre(), (-80.0, 0.0), 1)

    before = d.c.session.camera
    panel = imgui.internal.find_window_by_name("Statistics")
    d.drag((panel.pos.x + 60.0, panel.pos.y + panel.size.y - 20.0), (50.0, -30.0))
    assert d.c.session.camera == before, "a drag on a panel moved the camera"

    d.ui.show_panel("Camera")
    d.frames(3)
    d.context.item_click("//Camera/##bookmark")
    d.context.key_chars("wasd")
    d.frames(3)
    assert d.ui.new_bookmark == "wasd"
    assert d.c.session.camera == before, "typing moved the camera"
    d.context.key_press(KEY.enter)
    d.frames(2)
    assert d.c.keeper.bookmarks[0]["name"] == "wasd"
    d.context.mouse_move_to_pos(d.picture_centre())
    d.context.mouse_click(0)
    d.frames(2)
    assert d.c.selected is not None and d.c.session.camera == before, "a click only inspects"

    d.press(KEY.r)
    assert d.c.session.follow
    d.wait(lambda: d.c.session.camera == home, "the scene's own camera")
    d.c.keeper.go_to_bookmark(0)
    d.wait(lambda: not d.c.moving, "the glide to the bookmark")
    assert math.dist(d.c.session.camera.position, before.position) < 1e-9
    d.settle()


def orbiting(d: Driver) -> None:
    """An orbit keeps the distance to what was clicked; F goes near it; the wheel comes nearer."""
    d.settle()
    d.press(KEY.o)
    assert d.c.preferences.navigation == "orbit"
    d.drag(d.picture_centre(), (90.0, 40.0))
    pivot, camera = d.ui.pivot, d.c.session.camera
    assert pivot is not None and not d.c.session.follow
    d.settle()
    d.drag(d.picture_centre(), (0.0, 0.0))
    distance = math.dist(camera.position, pivot)
    d.context.mouse_move_to_pos(d.picture_centre())
    d.frames(2)
    d.context.mouse_wheel_y(3.0)
    d.frames(3)
    assert math.dist(d.c.session.camera.position, d.ui.pivot) < distance
    d.settle()
    d.press(KEY.f)
    d.wait(lambda: not d.c.moving, "the glide of the focus")
    view = d.c.session.camera.basis()[2]
    to_pivot = np.subtract(d.ui.pivot, d.c.session.camera.position)
    assert view @ to_pivot / np.linalg.norm(to_pivot) > 0.9999
    d.settle()


def playing(d: Driver) -> None:
    """Play, pause, step and scrub; every frame is traced in full where that was asked for."""
    d.settle()
    d.press(KEY.space)
    assert d.c.session.playing
    d.wait(lambda: d.c.session.time > 0.3, "time to pass")
    d.press(KEY.space)
    assert not d.c.session.playing
    d.settle()
    assert d.c.frame.time == d.c.session.time
    frame = d.c.session.frame
    d.press(KEY.right_arrow)
    assert d.c.session.frame == frame + 1
    d.press(KEY.left_arrow)
    d.press(KEY.home)
    assert d.c.session.frame == 0
    d.c.preferences.every_frame = True
    d.c.preferences.loop = False
    d.settle()
    d.c.history.clear()
    d.press(KEY.space)
    d.wait(lambda: not d.c.session.playing, "the last frame")
    d.settle()
    assert d.c.session.frame == d.c.session.scene.frames - 1
    assert d.c.history.frames >= d.c.session.scene.frames - 1
    assert len(set(d.c.history.values("pixels"))) == 1, "all in full resolution"


def capturing(d: Driver) -> None:
    """Pictures with and without panels; dropping one brings everything back."""
    pictures = d.folder / "pictures"
    d.settle()
    d.press(KEY._2)
    d.hold(KEY.d, 0.2)
    d.press(KEY.c)
    d.settle()
    d.c.preferences.screenshot_template = "{scene}-{view}-{frame:04d}.png"
    d.press(KEY.f12)
    d.wait(lambda: not d.c.keeper.busy, "the picture to be written")
    d.press(int(KEY.f12) | int(KEY.mod_shift))
    d.wait(lambda: not d.c.keeper.busy, "the window's picture to be written")
    files = sorted(p.name for p in pictures.iterdir())
    assert files == ["tiny-occlusion-0000-2.png", "tiny-occlusion-0000.png"]
    with Image.open(pictures / files[1]) as alone, Image.open(pictures / files[0]) as window:
        assert alone.size == (d.c.frame.width, d.c.frame.height)
        assert window.size == tuple(glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui()))
        assert np.array_equal(np.asarray(alone), d.shown())
        data = json.loads(alone.text["shadowcull"])
    assert data["statistics"]["shadow"]["due"] == d.c.frame.statistics.shadow.due
    camera = d.c.session.camera
    for key in (KEY.c, KEY._1, KEY.r):
        d.press(key)
    d.settle()
    assert d.c.session.camera != camera
    d.drop(pictures / files[1])
    assert d.c.session.camera == camera
    assert d.c.session.view is View.OCCLUSION and d.c.session.settings.method == "none"
    d.c.preferences.screenshot_template = "moving.png"
    d.hold(KEY.d, 0.3)
    d.press(KEY.f12)
    d.settle()
    d.wait(lambda: (pictures / "moving.png").exists(), "the picture of a camera that has just come to rest")
    with Image.open(pictures / "moving.png") as picture:
        assert picture.size == (d.c.frame.width, d.c.frame.height), "the fine picture is waited for"
    d.c.preferences.screenshot_template = "{nonsense}"
    d.press(KEY.f12)
    assert d.c.message.error and "nonsense" in d.c.message.text
    (d.folder / "file").write_text("")
    d.c.preferences.screenshot_folder, d.c.preferences.screenshot_template = str(d.folder / "file"), "a.png"
    d.press(KEY.f12)
    d.wait(lambda: not d.c.keeper.busy, "the failure to write")
    d.frames(2)
    assert d.c.message.error and "cannot write" in d.c.message.text
    d.settle()


def dropping(d: Driver) -> None:
    """Scenes open; whatever is none is one line, and the open scene stays."""
    d.settle()
    scene = d.c.session.scene
    bad = d.folder / "bad.aff"
    bad.write_text("l 1 2\nf 1 1\np 3\n0 0 zero\n")
    text = d.folder / "notes.txt"
    text.write_text("hello")
    fake = d.folder / "fake.png"
    fake.write_bytes(b"no picture")
    for path in (bad, text, fake, d.folder / "gone.aff", d.folder):
        d.c.message = None
        d.drop(path)
        d.wait(lambda: not d.c.opener.busy, "the load to fail")
        d.frames(2)
        assert d.c.message is not None and d.c.message.error, f"{path} was not refused"
        assert path.name in d.c.message.text and "\n" not in d.c.message.text
        assert d.c.session.scene is scene
    lights = "\n".join(f"l {i} 5 3 0.1 0.1 0.1" for i in range(40))
    many = d.folder / "many.aff"
    many.write_text(Path(scene.path).read_text() + lights)
    d.drop(many, text)
    d.wait(lambda: d.c.session.scene is not scene, "the other scene")
    d.settle()
    assert len(d.c.session.scene.lights) == 42
    d.c.set_view(View.SHADOW)
    d.c.set_light(35)
    d.frames(3)
    dark = d.folder / "dark.nff"
    dark.write_text(
        "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0.1\nresolution 8 8\nf 1 0 0 1 0 1 0 1\ns 0 0 0 1\n"
    )
    d.drop(dark)
    d.wait(lambda: d.c.session.scene.path.name == "dark.nff", "the scene without lights")
    d.settle()
    d.press(KEY._3)
    assert d.c.frame.primitive.max() >= 0


def reopening(d: Driver) -> None:
    """A picture saved in a view that needs more of a frame opens over another scene; so do the keys of such views."""
    d.c.preferences.screenshot_template = "{view}.png"
    d.settle()
    first = Path(d.c.session.scene.path)
    for key in ("H", "Shift+H", "8", "9"):
        d.press(chord(key))
        d.settle()
        d.press(KEY.f12)
        d.wait(lambda: not d.c.keeper.busy, "the picture to be written")
    d.press(KEY._1)
    take = d.c.render.take
    for view in (View.SAVED, View.COST, View.DIFFERENCE, View.WIPE):
        d.drop(embedded_scenes()["figure4"])
        d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the other scene")
        d.press(KEY._1)
        d.settle()
        d.c.render.take = lambda: None  # the first frame of the scene is long in coming
        d.drop(d.folder / "pictures" / f"{view}.png")
        d.wait(lambda: d.c.session.scene.path == first, "the picture's scene")
        assert d.c.session.view is view and d.c.frame is None
        for key in ("8", "9", "H", "Shift+H", "0", "3", view.key):
            d.press(chord(key))
        d.press(KEY.f12)
        d.c.render.take = take
        d.settle()
        assert d.c.tracing.drawn_view is view
        expected = picture(d.c.frame, view, shading=d.c.preferences.shading)
        assert np.abs(d.shown().astype(int) - expected).max() <= 2


def failing(d: Driver) -> None:
    """Whatever fails, in drawing, a panel, a menu, a command or a thread, is a notice; the window lives on."""
    d.settle()
    faults, log, guard, display = d.c.faults, d.c.log, d.ui.guard, d.ui.display
    again = f"{icons.ICON_FA_ROTATE_RIGHT}  Try again"

    def fail(*_: object) -> None:
        raise ZeroDivisionError("made to fail")

    def told(about: str, times: int = 1) -> None:
        """There is a notice, of one failure only, with all that is known; it is copied, and goes."""
        d.wait(lambda: faults.notice is not None, f"a notice about {about}", 20.0)
        d.frames(8)  # a flood would be counted by now
        notice = faults.notice
        assert about in notice.text and "made to fail" in notice.text and "Traceback" in notice.details, notice
        assert notice.count == times and len([e for e in log.entries() if e.text == notice.text]) == 1
        d.context.item_click(f"//##fault/{icons.ICON_FA_COPY}  Copy details")
        d.frames(2)
        assert imgui.get_clipboard_text() == notice.told
        d.context.item_click("//##fault/Dismiss")
        d.frames(3)
        assert faults.notice is None and d.c.frame is not None

    # Drawing: the picture stays what it was, is not tried again until it should be another, and is not saved as one.
    before, frame = d.shown(), d.c.frame
    draw_into, display._draw_into = display._draw_into, fail
    d.press(KEY._5)
    told("Drawing the picture")
    assert np.array_equal(d.shown(), before)
    d.press(KEY.f12)
    d.frames(3)
    assert not (d.folder / "pictures").exists() and "no picture to save" in d.c.message.text
    faults.dismiss()
    display._draw_into = draw_into
    d.press(KEY._6)
    expected = picture(frame, View.NORMAL, shading=d.c.preferences.shading)
    assert np.abs(d.shown().astype(int) - expected).max() <= 2
    most, display.context.info["GL_MAX_TEXTURE_SIZE"] = display.context.info["GL_MAX_TEXTURE_SIZE"], 16
    d.c.preferences.fixed_resolution, d.c.preferences.fixed_width, d.c.preferences.fixed_height = True, 120, 90
    d.settle()
    assert "120 x 90 is too large for this GPU" in faults.notice.text
    display.context.info["GL_MAX_TEXTURE_SIZE"] = most
    d.c.preferences.fixed_resolution = False
    d.settle()
    assert display.size == (d.c.frame.width, d.c.frame.height)
    faults.dismiss()

    # Panels, with tables, children and plots open: one says what is wrong with it, and is shown again when told to.
    for label, module, name in (("Statistics", statistics, "_milliseconds"), ("Plots", plots, "_stack")):
        d.ui.show_panel(label)
        d.frames(3)
        good = getattr(module, name)
        setattr(module, name, fail)
        told(f"The panel {label}")
        assert f"The panel {label}" in guard.broken
        d.context.item_click(f"//{label}/{again}")
        told(f"The panel {label}", 2)
        setattr(module, name, good)
        d.context.item_click(f"//{label}/{again}")
        d.frames(3)
        assert not guard.broken

    # Bars, dialogs and commands.
    for module, name, part in ((commands, "menus", "The menus"), (status, "_summary", "The status bar")):
        good = getattr(module, name)
        setattr(module, name, fail)
        told(part)
        setattr(module, name, good)
        assert part in guard.broken
        guard.again(part)
        d.frames(3)
        assert not guard.broken
    good, browser._listing = browser._listing, fail
    d.press(int(KEY.o) | int(KEY.mod_ctrl))
    told("The dialog that opens a file")
    assert not d.ui.browser.open
    browser._listing = good
    d.ui.commands = [replace(c, run=fail) if c.name == "Depth" else c for c in d.ui.commands]
    d.press(KEY._5)
    told("The command Depth")
    d.context.menu_click("//##MainMenuBar/View/Depth")
    told("The command Depth", 2)

    # Threads.
    threading.Thread(target=fail, name="some thread").start()
    told("some thread")
    renderer = d.c.render._renderer
    refine, renderer.refine = renderer.refine, fail
    d.press(KEY.t)
    told("frame not traced")
    renderer.refine = refine
    d.press(KEY.t)
    d.settle()
    read, opening.load_visible_scene = opening.load_visible_scene, fail
    d.drop(embedded_scenes()["figure4"])
    told("Loading figure4.aff failed")
    opening.load_visible_scene = read

    # All of it is in the log, with what the status bar has said.
    d.ui.show_panel("Log")
    d.frames(3)
    texts = [e.text for e in log.entries()]
    assert sum("made to fail" in t for t in texts) >= 10 and any("opened in" in t for t in texts)
    d.context.item_click(f"//Log/{icons.ICON_FA_COPY}  Copy all")
    d.frames(2)
    assert all(t in imgui.get_clipboard_text() for t in texts)
    d.context.item_click("//Log/Clear")
    d.frames(2)
    assert not log.entries()


def asking(d: Driver) -> None:
    """While an experiment runs, opening and quitting ask first; the answer that stops it keeps what is done."""
    d.settle()
    runner, scene = d.c.runner, d.c.session.scene
    first, other = Path(scene.path), embedded_scenes()["figure4"]
    runner.experiment_plan.frames, runner.experiment_plan.size = 3000, (64, 48)

    def under_way() -> None:
        if runner.current is None:
            runner.start_experiment()
        d.wait(lambda: runner.experiment.done_of[0] > 1, "frames of the experiment")

    def answer(name: str) -> None:
        d.frames(3)
        assert d.c.asking.question is not None and runner.current is not None, "nobody has asked"
        d.context.item_click(f"//{d.c.asking.question.title}###question/{name}")
        d.frames(3)
        assert d.c.asking.question is None

    under_way()
    for ask in (lambda: d.drop(other), lambda: d.press(KEY.f5), lambda: d.press(int(KEY.q) | int(KEY.mod_ctrl)),
                lambda: d.c.opener.open(other)):  # fmt: skip
        ask()
        answer("Keep running")
        assert runner.current is not None and not runner.current.stopping and d.c.opener.load_job is None
    d.drop(other)
    d.frames(3)
    d.press(KEY.escape)
    assert d.c.asking.question is None and not runner.current.stopping, "Escape has stopped it beside the question"
    d.drop(d.folder / "gone.aff")
    assert d.c.asking.question is None and "no such file" in d.c.message.text
    run = runner.experiment
    d.drop(other)
    answer("Stop and open")
    d.wait(lambda: d.c.session.scene.path == other and runner.current is None, "the other scene")
    d.settle()
    assert run is runner.experiment and run.results is not None and not run.whole
    d.ui.show_panel("Experiment")
    d.frames(3)
    _saved(d, "Experiment")
    d.drop(first)
    d.wait(lambda: d.c.session.scene.path == first, "the first scene again")
    d.settle()

    # Escape closes what lies over the panels, one by one, and stops the run only when nothing does.
    under_way()
    d.context.menu_click("//##MainMenuBar/Help/About Shadowcull")
    d.press(KEY.f1)
    assert d.ui.about_open and d.ui.shortcuts_open
    popups = lambda: len(imgui.get_current_context().open_popup_stack)  # noqa: E731
    for there in ("//##MainMenuBar/##MenuBar/File", f"//Scene/{icons.ICON_FA_CLOCK_ROTATE_LEFT}  Recent"):
        d.context.item_click(there)
        d.frames(2)
        assert popups() == 1
        d.press(KEY.escape)
        assert popups() == 0 and d.ui.about_open and d.ui.shortcuts_open
    d.press(KEY.escape)
    assert not d.ui.about_open and d.ui.shortcuts_open
    d.press(KEY.escape)
    assert not d.ui.shortcuts_open and not runner.current.stopping
    d.press(KEY.escape)
    d.wait(lambda: runner.current is None, "the experiment to stop", 20.0)
    d.settle()

    under_way()
    before = set((d.folder / "pictures").glob("*"))
    d.app._close_wanted(glfw_utils.glfw_window_hello_imgui())
    closed_with: list[set[Path]] = []
    leave = d.app._exit
    d.app._exit = lambda: closed_with.append(set((d.folder / "pictures").glob("*")) - before)  # type: ignore
    answer("Save and quit")
    d.wait(lambda: bool(closed_with), "the files to be written, and the end", 30.0)
    assert {path.suffix for path in closed_with[0]} == {".json", ".csv", ".png"}
    leave()


def closing_panels(d: Driver) -> None:
    """The cross closes one panel of several behind each other's tabs, and the default layout brings all back."""
    d.settle()
    docking = d.app.params.docking_params
    closed = lambda: [w.label for w in docking.dockable_windows if not w.is_visible]  # noqa: E731
    d.ui.show_panel("Camera")
    d.frames(3)
    d.context.window_close("//Camera")
    d.frames(3)
    assert closed() == ["Camera"]
    for label in ("Scene", "View", "Plots", "Log"):
        docking.dockable_window_of_name(label).is_visible = False
    d.frames(3)
    d.context.menu_click("//##MainMenuBar/View/Default layout")
    d.frames(6)
    assert not closed()
    docked = imgui.internal.find_window_by_name("Scene").dock_node
    assert docked is not None and imgui.internal.find_window_by_name("Camera").dock_id == docked.id_


def looks(d: Driver) -> None:
    """Theme and size of the interface change at once and are kept; settings are reset when the user agrees."""
    d.settle()
    p, small = d.c.preferences, imgui.get_font_size()
    d.c.keeper.add_bookmark("here")

    def brightness() -> float:
        """Of the window where nothing is drawn: the menu bar's right end."""
        got: list[np.ndarray] = []
        size = glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui())
        d._in_frame.append(lambda: got.append(d.ui.display.read_window(*size)))
        d.wait(lambda: bool(got), "the window to be read")
        return float(got[0][6, -40:].mean())

    assert brightness() < 60.0
    d.context.menu_click("//##MainMenuBar/View/Light theme")
    d.frames(4)
    assert p.theme == "light" and brightness() > 200.0
    for _ in range(3):
        d.press(int(KEY.equal) | int(KEY.mod_ctrl))
    d.frames(4)
    assert p.ui_scale == 1.5 and abs(imgui.get_font_size() - 1.5 * small) <= 1.0
    d.press(int(KEY._0) | int(KEY.mod_ctrl))
    d.frames(4)
    assert p.ui_scale == 1.0 and imgui.get_font_size() == small and d.c.session.view is View.COLOR
    d.press(int(KEY.minus) | int(KEY.mod_ctrl))
    d.press(KEY._4)
    for answer, after in (("Keep them", "light"), ("Reset", "dark")):
        d.context.menu_click("//##MainMenuBar/File/Reset settings...")
        d.frames(3)
        d.context.item_click(f"//Reset all settings?###question/{answer}")
        d.frames(4)
        assert p.theme == after
    assert p.ui_scale == 1.0 and d.c.session.view is View.COLOR and brightness() < 60.0
    assert p.recent and d.c.keeper.bookmarks[0]["name"] == "here"
    d.c.asking.before_resetting()
    d.frames(3)
    d.context.item_click("//Reset all settings?###question/Forget bookmarks as well")
    d.context.item_click("//Reset all settings?###question/Reset")
    d.frames(3)
    assert not d.c.keeper.bookmarks and p.recent

    # What is open now is where the next start may begin; a scene that has gone since is told of.
    d.context.menu_click("//##MainMenuBar/File/Start where I left off")
    d.hold(KEY.d, 0.2)
    d.settle()
    camera, path = d.c.session.camera, d.c.session.scene.path
    p.last = d.c.session.snapshot().to_json()
    d.press(KEY.r)
    assert p.start_where_left and d.c.session.camera != camera
    assert d.c.opener.go_on()
    d.wait(lambda: d.c.session.camera == camera, "the place that was left")
    assert d.c.session.scene.path == path
    d.settle()
    p.last = p.last | {"scene": str(d.folder / "gone.aff")}
    assert not d.c.opener.go_on() and "the scene is gone" in d.c.message.text
    d.settle()


def cancelling(d: Driver) -> None:
    """A load that is cancelled leaves the open scene as it is."""
    d.settle()
    scene, frame = d.c.session.scene, d.c.frame
    d.drop(d.folder / "big.aff")
    assert d.c.opener.load_job is not None
    d.press(KEY.escape)
    d.wait(lambda: d.c.opener.load_job is None, "the load to stop", 20.0)
    d.frames(3)
    assert d.c.session.scene is scene and d.c.frame is frame
    assert "cancelled" in d.c.message.text


def resizing(d: Driver) -> None:
    """The picture follows the window, keeps a fixed resolution's aspect, and rests while minimised."""
    d.settle()
    window = glfw_utils.glfw_window_hello_imgui()
    for size in ((1300, 900), (640, 400), (200, 120), (1000, 700)):
        glfw.set_window_size(window, *size)
        d.frames(4)
        d.settle()
        if min(d.c.size) > 0:
            assert (d.c.frame.width, d.c.frame.height) == d.c.size
    d.c.preferences.fixed_resolution, d.c.preferences.fixed_width, d.c.preferences.fixed_height = True, 120, 90
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == (120, 90)
    d.app._room_for_picture = lambda: (0, 0)  # as while minimised; without a window manager nothing minimises
    d.frames(3)
    traced = d.c.history.frames
    d.press(KEY.t)
    d.frames(5)
    assert d.c.history.frames == traced, "a window that cannot be seen is traced for"
    del d.app._room_for_picture
    d.settle()
    assert d.c.history.frames == traced + 1


def closing_while_tracing(d: Driver) -> None:
    """The window goes at once, whatever is being traced."""
    d.settle()
    d.c.change(samples=4000)
    d.wait(lambda: d.c.render.running is not None and d.c.render.running.samples == 4000, "a long trace")
    _close(d)


def closing_while_experimenting(d: Driver) -> None:
    """The window goes at once, whatever is being measured."""
    d.settle()
    d.c.runner.experiment_plan.size = (2048, 2048)
    d.c.runner.start_experiment()
    d.wait(lambda: d.c.runner.experiment.traced > 0, "a first frame")
    _close(d)


def experimenting(d: Driver) -> None:
    """An experiment starts from its panel, plays, can be stopped, and leaves a table, a plot and files."""
    d.settle()
    runner, home, method = d.c.runner, d.c.session.camera, d.c.session.settings.method
    d.ui.show_panel("Experiment")
    d.frames(3)
    runner.experiment_plan.frames, runner.experiment_plan.size = 3000, (64, 48)
    d.context.item_click("//Experiment/**/##verify")
    assert runner.experiment_plan.verify
    d.context.item_click(f"//Experiment/**/{icons.ICON_FA_PLAY}  Start")
    run = runner.experiment
    for _ in range(3):
        before = run.traced
        d.wait(lambda: run.traced > before + 3, "frames of the experiment")  # noqa: B023
        assert (d.c.frame.width, d.c.frame.height) == (64, 48) == d.ui.display.size, "they are not the picture"
    d.hold(KEY.w, 0.1)
    assert d.c.session.camera == home and "stop it first" in d.c.message.text
    d.press(KEY.c)
    assert d.c.session.settings.method == method
    d.press(KEY._2)
    assert d.c.session.view is View.OCCLUSION, "a view can be chosen any time"
    d.context.item_click(f"//Experiment/**/{icons.ICON_FA_STOP}  Stop")
    d.wait(lambda: runner.current is None, "the experiment to stop", 20.0)
    assert 3 <= len(run.results.frames) < 3000 and "what was done is kept" in d.c.message.text
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.size and d.c.frame.camera == home

    runner.experiment_plan.frames = 6
    d.context.menu_click("//##MainMenuBar/Run/Experiment")
    d.wait(lambda: runner.current is None, "the experiment to end")
    d.settle()
    assert runner.experiment is not run and runner.experiment.whole
    files = _saved(d, "Experiment")
    assert len(json.loads(files[".json"].read_text())["frames"]) == 6
    assert files[".csv"].read_text().splitlines()[1].startswith("none,")


def zooming(d: Driver) -> None:
    """A zoom test starts from its panel, plays, and leaves plots, steps to go to, and files; Escape stops another."""
    d.settle()
    runner = d.c.runner
    d.ui.show_panel("Zoom test")
    d.frames(3)
    start = f"//Zoom test/**/{icons.ICON_FA_PLAY}  Start"
    d.context.item_click(start)
    d.frames(2)
    assert runner.zoom_test is None and "click a primitive" in d.c.message.text
    d.context.mouse_move_to_pos(d.picture_centre())
    d.context.mouse_click(0)
    d.frames(2)
    assert d.c.selected is not None
    runner.zoom_plan.steps, runner.zoom_plan.size = 5, (64, 64)
    d.context.item_click(start)
    d.wait(lambda: runner.current is None, "the zoom test")
    d.settle()
    test = runner.zoom_test
    assert test.whole and [a.factor for a in test.results.approaches] == [4.0, 16.0]
    d.context.item_click("//Zoom test/**/all steps")
    d.frames(3)
    step = test.results.approaches[0].steps[4]  # farther down, a row is out of the pointer's reach
    d.context.item_click("//Zoom test/**/4##4")
    d.frames(3)
    assert d.ui.screening.step() is step
    d.context.item_click("//Picture/**/Fly there")
    d.settle()
    assert d.ui.screening is None
    assert np.allclose(d.c.frame.camera.position, step.camera.position)
    files = _saved(d, "Zoom test")
    assert json.loads(files[".json"].read_text())["primitive"] == test.start.primitive
    assert len(files[".csv"].read_text().splitlines()) == 1 + test.frames

    runner.zoom_plan.steps, runner.zoom_plan.ratio = 1000, 0.999
    d.context.item_click(start)
    d.wait(lambda: runner.zoom_test.traced > 5, "steps")
    d.press(KEY.escape)
    d.wait(lambda: runner.current is None, "the zoom test to stop", 20.0)
    assert len(runner.zoom_test.results.approaches[0].steps) >= 5
    d.settle()


def _saved(d: Driver, panel: str) -> dict[str, Path]:
    """Save results by the panel's buttons; the files by their endings."""
    folder = d.folder / "pictures"
    before = set(folder.glob("*"))
    for kind in ("JSON", "CSV", "Plot"):
        d.context.item_click(f"//{panel}/**/{icons.ICON_FA_FLOPPY_DISK} {kind}")
    d.wait(lambda: not d.c.keeper.busy, "the files to be written")
    d.frames(2)
    assert not d.c.message.error, d.c.message.text
    files = {path.suffix: path for path in set(folder.glob("*")) - before}
    assert set(files) == {".json", ".csv", ".png"}
    with Image.open(files[".png"]) as plot:
        assert plot.size == (1920, 1080)
    return files


def closing_while_loading(d: Driver) -> None:
    """The window goes at once, whatever is being loaded."""
    d.wait(lambda: d.c.session.scene is not None, "the first scene")
    d.drop(d.folder / "big.aff")
    d.wait(lambda: d.c.opener.load_job is not None, "a load")
    _close(d)


def _close(d: Driver) -> None:
    began = time.monotonic()
    closed = d.c.close

    def timed(*args: float) -> bool:
        done = closed(*args)
        assert done, "a thread would not stop"
        assert time.monotonic() - began < 10.0, "closing took too long"
        return done

    d.c.close = timed
    d.app._exit()


def panels(d: Driver) -> None:
    """Every panel, dialog and menu is shown once, as a new user would open them."""
    d.settle()
    d.press(KEY.b)
    for label in ("Camera", "Rendering", "Saving", "Scene", "View", "Experiment", "Zoom test", "Plots"):
        d.app.params.docking_params.focus_dockable_window(label)
        d.frames(3)
    d.press(KEY.f1)
    assert d.ui.shortcuts_open
    d.frames(3)
    d.press(KEY.f1)
    d.context.menu_click("//##MainMenuBar/Help/About Shadowcull")
    d.frames(3)
    assert d.ui.about_open
    d.ui.about_open = False
    d.press(int(KEY.o) | int(KEY.mod_ctrl))
    d.frames(4)
    assert d.ui.browser.open
    d.ui.browser.folder = d.folder
    d.frames(2)
    before = d.c.session.view
    d.context.key_press(KEY._5)
    d.frames(2)
    assert d.c.session.view is before, "a key reached the window behind a dialog"
    d.press(KEY.escape)
    assert not d.ui.browser.open
    d.context.menu_click("//##MainMenuBar/View/Depth")
    d.frames(2)
    assert d.c.session.view is View.DEPTH
    d.c.preferences.keep_tracing = True
    traced = d.c.history.frames
    d.c.trace_again()
    d.wait(lambda: d.c.history.frames >= traced + 3, "frames at rest")
    d.c.preferences.keep_tracing = False


def browsing(d: Driver) -> None:
    """The dialog that opens a file, with the keyboard alone and then with the pointer."""
    d.settle()
    box = d.folder / "box"
    (box / "inner").mkdir(parents=True)
    scene = Path(d.c.session.scene.path).read_text()
    for name in ("whole.aff", "inner/deep.aff"):
        (box / name).write_text(scene)
    (box / "wheel.aff").write_text("f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n")
    Image.new("RGB", (8, 8)).save(box / "plot.png")
    b = d.ui.browser
    b.folder = d.folder

    def keys(text: str) -> None:
        d.context.key_chars(text)
        d.frames(2)
        d.wait(lambda: not b.reading, "the folder to be read")

    d.press(int(KEY.o) | int(KEY.mod_ctrl))
    d.frames(2)
    keys("bo")
    d.press(KEY.tab)
    assert b.typed == "box/", b.typed
    d.wait(lambda: not b.reading, "the folder to be read")
    assert [e.name for e in b.shown()] == ["inner/", "whole.aff", "wheel.aff"]
    keys("WH")
    assert [e.name for e in b.shown()] == ["whole.aff", "wheel.aff"] and b.aimed() is None
    d.press(KEY.down_arrow, 2)
    assert b.marked == "wheel.aff"
    d.press(KEY.up_arrow)
    assert b.marked == "whole.aff" and b.typed == "box/WH"
    d.press(KEY.enter)
    assert not b.open and b.folder == box
    d.wait(lambda: d.c.session.scene.path.name == "whole.aff", "the scene that was chosen")
    d.settle()

    # What cannot be opened is refused where it was asked for.
    d.press(int(KEY.o) | int(KEY.mod_ctrl))
    d.frames(2)
    keys("plot.png")
    d.press(KEY.enter)
    assert b.open and "not one captured" in b.problem
    d.frames(2)
    d.press(int(KEY.a) | int(KEY.mod_ctrl))
    keys("inn")
    assert not b.problem
    d.press(KEY.enter)
    d.wait(lambda: not b.reading, "the folder to be read")
    assert b.open and b.folder == box / "inner" and b.typed == ""

    # A click marks, and the line to type in keeps the keyboard; a double click opens.
    d.context.set_ref(d.context.window_info(f"//{browser.TITLE}/files").window)
    row = "deep.aff/##row"
    d.context.item_click(row)
    d.frames(3)
    assert b.open and b.marked == "deep.aff"
    d.context.item_double_click(row)
    d.frames(3)
    assert not b.open
    d.wait(lambda: d.c.session.scene.path.name == "deep.aff", "the scene in the folder")
    d.settle()
