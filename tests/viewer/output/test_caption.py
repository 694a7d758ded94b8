"""Captions are where they belong; and a clipboard that is there is used."""

from __future__ import annotations

import stat
from pathlib import Path

import numpy as np
import pytest

from viewer.output import clipboard
from viewer.output.caption import with_caption


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
