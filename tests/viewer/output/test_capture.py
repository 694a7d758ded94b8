"""A saved picture carries what it needs, never overwrites, and fails in one line; captions and small pictures."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from tracer.scene.model import Camera
from tracer.settings import Settings
from viewer.output import capture
from viewer.output.overlays import with_caption
from viewer.state import codec
from viewer.state.draw_options import DrawOptions
from viewer.state.view_state import ViewState
from viewer.state.views import View

NOW = datetime(2024, 5, 31, 14, 5, 9)
VALUES = {"scene": "kitchen", "view": "shadow", "frame": 7, "seconds": 1.25, "method": "paper", "light": 2,
          "width": 640, "height": 480}  # fmt: skip
PIXELS = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)

CAMERA = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))
STATE = ViewState(
    "/scenes/kitchen.aff", time=1.25, camera=CAMERA, settings=Settings(6, 4, method="none"),
    draw=DrawOptions(View.SHADOW, 2),
)  # fmt: skip


def text() -> str:
    return capture.Carried(codec.state_to_json(STATE, of_picture=True), CAMERA.to_json(), 7, (6, 4)).text()


def test_a_picture_brings_back_its_state_and_its_pixels(tmp_path: Path):
    path = capture.save(PIXELS, text(), tmp_path / "new" / "folder", "a.png")
    assert capture.read(path) == STATE
    with Image.open(path) as image:
        assert np.array_equal(np.asarray(image), PIXELS)


def test_a_state_is_read_without_decoding_the_pixels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The window waits for it, and a picture may be large."""
    path = capture.save(PIXELS, text(), tmp_path, "a.png")
    monkeypatch.setattr(PngImagePlugin.PngImageFile, "load", lambda self: pytest.fail("its pixels are decoded"))
    assert capture.read_carried(path).frame == 7


def test_nothing_is_overwritten(tmp_path: Path):
    first, second, third = (capture.save(PIXELS + i, text(), tmp_path, "a.png") for i in range(3))
    assert [p.name for p in (first, second, third)] == ["a.png", "a-2.png", "a-3.png"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a-2.png", "a-3.png", "a.png"]


@pytest.mark.parametrize(
    ("template", "name"),
    [
        ("{scene}-{view}-{frame:04d}-{date}-{time}.png", "kitchen-shadow-0007-2024-05-31-14-05-09.png"),
        ("{scene}", "kitchen.png"),
        ("t={seconds:.2f} {width}x{height}.PNG", "t=1.25 640x480.png"),
        ("../{scene}/..\\x:y", "..-kitchen-..-x-y.png"),
        ("x" * 400, "x" * 200 + ".png"),
    ],
)
def test_templates_become_file_names(template: str, name: str):
    assert capture.file_name(template, VALUES, NOW) == name


@pytest.mark.parametrize(
    "template",
    ["{sceen}", "{frame:zz}", "{", "}", "{frame!q}", "", " .png", "{scene.__class__}", "{frame:9999999d}", "{0}", "{}"],
)  # fmt: skip
def test_templates_that_are_wrong(template: str):
    with pytest.raises(capture.CaptureError, match="template") as caught:
        capture.file_name(template, VALUES, NOW)
    assert "\n" not in str(caught.value)


def test_a_folder_that_cannot_be_written_to_is_one_line(tmp_path: Path):
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(capture.CaptureError, match="cannot write to") as caught:
        capture.save(PIXELS, text(), tmp_path / "file" / "below", "a.png")
    assert "\n" not in str(caught.value)


def test_a_state_that_is_none_is_refused_in_one_line(tmp_path: Path):
    for carried, why in (('{"state": [1, 2]}', "no saved state in it"), ('{"a": ' * 10**5, "nested too deeply")):
        info = PngImagePlugin.PngInfo()
        info.add_itxt("shadowcull", carried)
        Image.fromarray(PIXELS).save(tmp_path / "wrong.png", pnginfo=info)
        with pytest.raises(capture.CaptureError, match=rf"wrong\.png.*cannot be restored: .*{why}") as caught:
            capture.read(tmp_path / "wrong.png")
        assert "\n" not in str(caught.value)


def test_a_program_named_like_a_picture_is_not_run(tmp_path, monkeypatch):
    started: list[int] = []
    monkeypatch.setattr("PIL.EpsImagePlugin.Ghostscript", lambda *_, **__: started.append(1))
    path = tmp_path / "saved.png"
    path.write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n")
    with pytest.raises(capture.CaptureError, match=r"saved\.png: cannot be read as a picture"):
        capture.read(path)
    assert not started


def test_a_caption_breaks_where_it_must() -> None:
    pixels = np.zeros((90, 120, 3), np.uint8)
    one, many = with_caption(pixels, "short"), with_caption(pixels, "many words " * 12)
    assert one.shape[1] == many.shape[1] == 120 and 90 < one.shape[0] < many.shape[0]
    assert np.array_equal(one[:90], pixels) and with_caption(pixels, "") is pixels
    strip = with_caption(pixels, "W" * 60)[90:]
    assert (strip[:, :2] == 255).all() and (strip[:, -2:] == 255).all(), "nothing is cut at the edges"
