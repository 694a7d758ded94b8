"""Shaders over a whole picture, compiled when they are first drawn, and shared by all that draw."""

from __future__ import annotations

from typing import Any

import moderngl

from viewer.util.resources import shader_source


class Passes:
    """Needs a current GL context, `context`."""

    def __init__(self) -> None:
        self.context = moderngl.create_context()
        self._made: dict[str, tuple[Any, Any]] = {}

    def made(self, name: str, before: str = "common.glsl", units: tuple[str, ...] = ()) -> tuple[Any, Any]:
        """The program of a fragment shader, after what it shares with others, and the triangle that it draws; textures
        of these names are read from units in that order."""
        if name not in self._made:
            version = "#version 330 core\n"
            program = self.context.program(
                vertex_shader=version + shader_source("fullscreen.vert"),
                fragment_shader=version + (shader_source(before) if before else "") + shader_source(f"{name}.frag"),
            )
            for unit, texture in enumerate(units):
                if texture in program:
                    program[texture] = unit
            self._made[name] = (program, self.context.vertex_array(program, []))
        return self._made[name]

    def draw(self, triangle: Any, target: Any) -> None:
        """Cover the target, with nothing blended or hidden."""
        target.use()
        self.context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        triangle.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        for program, triangle in self._made.values():
            triangle.release()
            program.release()
        self._made.clear()
