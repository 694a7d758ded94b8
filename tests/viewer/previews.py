"""What the preview has drawn, read back from the GPU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from viewer.window.preview import PreviewDisplay


def colors_of(preview: PreviewDisplay) -> NDArray[np.uint8]:
    """(height, width, 3), row 0 at the top."""
    width, height = preview._target.size
    return np.frombuffer(preview._target.read(components=3, alignment=1), np.uint8).reshape(height, width, 3)


def depths_of(preview: PreviewDisplay) -> NDArray[np.float32]:
    """(height, width) distances along the camera's view, in world units; infinite where nothing is seen."""
    width, height = preview._target.size
    stored = np.frombuffer(preview._target.depth_attachment.read(alignment=1), np.float32)
    near, far = preview._range
    with np.errstate(divide="ignore"):
        depth = 2.0 * far * near / (far + near - (2.0 * stored.astype(np.float64) - 1.0) * (far - near))
    return np.where(stored < 1.0, depth, np.inf).astype(np.float32).reshape(height, width)
