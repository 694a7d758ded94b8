"""The two pictures of a comparison on the GPU: A in a target of its own, and the signed difference in false colour."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.views import LESS, MORE, SAME
from viewer.window.display import Display, Look
from viewer.window.frame_textures import DisplayError
from viewer.window.passes import Passes


class SignedDifference:
    """A difference (h, w) as a texture, and the target it is drawn into."""

    def __init__(self, passes: Passes) -> None:
        self._passes = passes
        self._texture: Any = None
        self._target: Any = None
        self._drawn: tuple[int, float] = (0, 0.0)
        self._shown: NDArray[np.float32] | None = None

    @property
    def texture_id(self) -> int | None:
        return self._target.color_attachments[0].glo if self._target is not None else None

    @property
    def picture(self) -> Any:
        """That texture, or None."""
        return self._target.color_attachments[0] if self._target is not None else None

    @property
    def version(self) -> object:
        """Another one whenever another picture has been drawn."""
        return self._drawn

    def draw(self, difference: NDArray[np.float32], limit: float) -> None:
        """Draw it as far as `limit` to both sides, unless it is there.  Raises DisplayError for what is too large."""
        if self._shown is difference and self._drawn == (id(difference), limit):
            return
        context, size = self._passes.context, difference.shape[::-1]
        most = context.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > most:
            raise DisplayError(f"{size[0]} x {size[1]} is too large for this GPU, which takes {most} pixels a side")
        window = context.detect_framebuffer()
        try:
            if self._texture is None or self._texture.size != size:
                self.release()
                self._texture = context.texture(size, 1, dtype="f4", alignment=1)
                picture = context.texture(size, 4)
                picture.filter = self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
                self._target = context.framebuffer([picture])
            if self._shown is not difference:
                self._texture.write(np.ascontiguousarray(difference, np.float32), alignment=1)
                self._shown = difference
            program, triangle = self._passes.made("signed", "", ("difference_buffer",))
            for name, value in {"limit": limit, "less": LESS, "same": SAME, "more": MORE}.items():
                program[name] = value
            self._texture.use(0)
            self._passes.draw(triangle, self._target)
        finally:
            window.use()
        self._drawn = id(difference), limit

    def read(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8 as it was drawn."""
        width, height = self._target.size
        data = self._target.read(components=3, alignment=1)
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)

    def release(self) -> None:
        if self._texture is not None:
            self._texture.release()
            self._target.color_attachments[0].release()
            self._target.release()
        self._texture = self._target = self._shown = None


class Compared:
    """What a comparison needs on the GPU beside the live picture; nothing of it stays when the comparison ends."""

    def __init__(self, passes: Passes) -> None:
        self._passes = passes
        self._a: Display | None = None
        self.difference = SignedDifference(passes)

    @property
    def a(self) -> Display | None:
        """What A is drawn in; None while it is not."""
        return self._a

    @property
    def a_texture(self) -> int | None:
        return self._a.texture_id if self._a is not None else None

    def draw_a(self, frame: Frame, look: Look) -> None:
        """Draw A as `Display.draw` does."""
        if self._a is None:
            self._a = Display(self._passes)
        self._a.show(frame)
        self._a.draw(look)

    def read_a(self) -> NDArray[np.uint8]:
        assert self._a is not None
        return self._a.read()

    def release(self) -> None:
        if self._a is not None:
            self._a.release()
            self._a = None
        self.difference.release()
