"""Small pictures as text."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

from viewer.output.thumbnail import SIDE, as_text, from_text, thumbnail


@pytest.mark.parametrize("size", [(480, 960), (1000, 500), (7, 3), (1, 1)])
def test_a_picture_comes_back_small_and_of_its_shape_and_colours(size: tuple[int, int]):
    color = np.zeros((*size, 3), np.float32)
    color[: max(1, size[0] // 2), :, 0] = 1.0
    text = as_text(thumbnail(color))
    back = from_text(text)
    assert back is not None and max(back.width, back.height) == min(SIDE, max(size)) and len(text) < 20_000
    assert back.width / back.height == pytest.approx(size[1] / size[0], rel=0.02)
    assert back.pixels().shape == (back.height, back.width, 3)
    assert back.thumbnail(9)[0, 0, 0] > 200 and (size[0] < 2 or back.pixels()[-1, 0, 0] < 60)


def test_what_is_no_number_is_black():
    assert thumbnail(np.full((8, 8, 3), np.nan, np.float32)).pixels().max() < 8


def test_anything_else_is_no_picture():
    file = io.BytesIO()
    Image.new("RGB", (4 * SIDE + 1, 4)).save(file, "JPEG")
    large = base64.b64encode(file.getvalue()).decode()
    for text in (None, "", 3, "no base64!", base64.b64encode(b"no picture").decode(), large, "A" * 300_000):
        assert from_text(text) is None
