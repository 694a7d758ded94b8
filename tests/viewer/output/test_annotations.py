"""Arrows, boxes, words and captions are where they belong, at any size; and a clipboard that is there is used."""

from __future__ import annotations

import stat
from pathlib import Path

import numpy as np
import pytest

from viewer.output import clipboard
from viewer.output.annotations import INK, annotated
from viewer.output.caption import with_caption
from viewer.state.annotations import Annotation, Kind, from_json


def bright(pixels: np.ndarray) -> np.ndarray:
    return (np.abs(pixels.astype(int) - INK).max(axis=-1) < 40).nonzero()


@pytest.mark.parametrize("size", [(120, 160), (600, 800)])
def test_what_is_drawn_is_where_it_was_put(size: tuple[int, int]) -> None:
    height, width = size
    plain = np.full((height, width, 3), 90, np.uint8)
    rows, columns = bright(annotated(plain, (Annotation(Kind.BOX, 0.5, 0.25, 0.25, 0.75),)))
    for found, expected in ((columns.min(), 0.25 * width), (columns.max(), 0.5 * width)):
        assert abs(found - expected) <= 0.02 * width
    for found, expected in ((rows.min(), 0.25 * height), (rows.max(), 0.75 * height)):
        assert abs(found - expected) <= 0.02 * height
    rows, columns = bright(annotated(plain, (Annotation(Kind.ARROW, 0.1, 0.5, 0.9, 0.5),)))
    assert abs(columns.max() - 0.9 * width) <= 0.02 * width and abs(columns.min() - 0.1 * width) <= 0.02 * width
    head = rows[columns > 0.85 * width]
    assert np.ptp(head) > 2 * np.ptp(rows[columns < 0.5 * width]), "the head is wider than the line"
    rows, columns = bright(annotated(plain, (Annotation(Kind.TEXT, 0.3, 0.6, text="here"),)))
    assert len(rows) and abs(columns.min() - 0.3 * width) < 0.04 * width and rows.min() >= 0.6 * height
    assert annotated(plain, ()) is plain


def test_annotations_survive_json() -> None:
    some = (Annotation(Kind.ARROW, 0.1, 0.2, 0.3, 0.4), Annotation(Kind.TEXT, 0.5, 0.5, text="größer"))
    assert from_json([each.to_json() for each in some]) == some
    for wrong in ({}, [1], [{"kind": "star"}], [{"kind": "box", "x0": "a"}], [{"kind": "box", "x0": float("nan")}],
                  [{"kind": "text", "text": "x" * 300}], [{"kind": "box"}] * 300):  # fmt: skip
        with pytest.raises(ValueError, match="annotation"):
            from_json(wrong)


def test_a_caption_breaks_where_it_must() -> None:
    pixels = np.zeros((90, 120, 3), np.uint8)
    one, many = with_caption(pixels, "short"), with_caption(pixels, "many words " * 12)
    assert one.shape[1] == many.shape[1] == 120 and 90 < one.shape[0] < many.shape[0]
    assert np.array_equal(one[:90], pixels) and with_caption(pixels, "") is pixels
    strip = with_caption(pixels, "W" * 60)[90:]
    assert (strip[:, :2] == 255).all() and (strip[:, -2:] == 255).all(), "nothing is cut at the edges"


def test_the_clipboard_is_that_of_the_desktop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("DISPLAY", ":9")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert clipboard.program() is None
    with pytest.raises(OSError, match="install xclip"):
        clipboard.copy(b"png")
    for name in ("xclip", "wl-copy"):
        program = tmp_path / name
        program.write_text(f'#!/bin/sh\nwhile read -r line; do echo "{name} $* $line" > {tmp_path}/got; done\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
    clipboard.copy(b"png\n")
    assert (tmp_path / "got").read_text() == "xclip -selection clipboard -target image/png -in png\n"
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    clipboard.copy(b"png\n")
    assert (tmp_path / "got").read_text() == "wl-copy --type image/png png\n"
    (tmp_path / "wl-copy").write_text("#!/bin/sh\nexit 3\n")
    with pytest.raises(OSError, match="wl-copy failed with code 3"):
        clipboard.copy(b"png")
