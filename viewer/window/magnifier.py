"""Pictures with crisp pixels, at the size at which they are shown: ImGui itself always smooths what it enlarges."""

from __future__ import annotations

from typing import Any

import moderngl

from viewer.state.pixels import Zoom
from viewer.util.resources import shader_source


class Magnifier:
    """Enlarged copies of pictures, by name; each stays until another is asked for under its name."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._program: Any = None
        self._triangle: Any = None
        self._targets: dict[str, Any] = {}
        self._shown: dict[str, tuple[Any, ...]] = {}

    def draw(self, name: str, source: Any, version: object, zoom: Zoom, size: tuple[int, int]) -> None:
        """Enlarge as much of a texture as the zoom shows to a size in pixels, unless it is there; `version` is another
        one whenever the texture's contents are."""
        wanted = source.glo, source.size, version, zoom, size
        if self._shown.get(name) == wanted:
            return
        context = self._context
        window = context.detect_framebuffer()
        try:
            target = self._targets.get(name)
            if target is None or target.size != size:
                self.drop(name)
                texture = context.texture(size, 4)
                texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
                target = self._targets[name] = context.framebuffer([texture])
            self._compile()
            left, top, right, bottom = zoom.shown()
            self._program["part"], self._program["size"] = (left, top, right - left, bottom - top), size
            source.use(0)
            target.use()
            context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            self._triangle.render(moderngl.TRIANGLES, vertices=3)
        finally:
            window.use()
        self._shown[name] = wanted

    def _compile(self) -> None:
        """Compile the shader when it is first needed."""
        if self._program is None:
            version = "#version 330 core\n"
            self._program = self._context.program(
                vertex_shader=version + shader_source("fullscreen.vert"),
                fragment_shader=version + shader_source("magnified.frag"),
            )
            self._triangle = self._context.vertex_array(self._program, [])

    def texture_of(self, name: str, source: int, zoom: Zoom, size: tuple[int, int]) -> int | None:
        """Name of the GL texture with that part of that source in that size; None while there is none."""
        shown = self._shown.get(name)
        there = shown is not None and (shown[0], shown[3], shown[4]) == (source, zoom, size)
        return self._targets[name].color_attachments[0].glo if there else None

    def drop(self, name: str) -> None:
        """Free a copy, if there is one."""
        target = self._targets.pop(name, None)
        self._shown.pop(name, None)
        if target is not None:
            target.color_attachments[0].release()
            target.release()

    def release(self) -> None:
        for name in list(self._targets):
            self.drop(name)
        if self._program is not None:
            self._triangle.release()
            self._program.release()
            self._program = None
