"""Commands of models that come alone, without camera and lights: their studio, and which way is up."""

from __future__ import annotations

from dataclasses import replace

from tracer.scene.meshes import MESH_EXTENSIONS
from tracer.scene.studio import TURNS, up_in_studio
from viewer.window.command import Command, Condition
from viewer.window.ui import Ui


def build(ui: Ui) -> list[Command]:
    """All of them, in the order of the menu."""
    c = ui.controller
    loader = c.loader

    def shown_up() -> str | None:
        return up_in_studio(c.session.scene) if c.session.scene is not None else None

    def is_mesh() -> bool:
        return c.session.scene is not None and c.session.scene.path.suffix.lower() in MESH_EXTENSIONS

    def wanted() -> bool:
        return c.session.meshes.studio if is_mesh() else loader.meshes.studio

    def toggle() -> None:
        if is_mesh():
            loader.read_as(replace(c.session.meshes, studio=not wanted()))
        else:
            loader.meshes = replace(loader.meshes, studio=not wanted())

    def turn() -> None:
        up = shown_up()
        if up is not None:
            following = TURNS[(TURNS.index(up) + 1) % len(TURNS)]
            loader.read_as(replace(c.session.meshes, up=following))

    stands = Condition(
        lambda: loader.load_job is None and shown_up() is not None, "no model stands in a studio, or one is being read"
    )
    return [
        Command("Studio", "File", toggle, checked=wanted, separated=True,
                tip="a floor, three lamps and an upright view for a mesh that brings neither camera nor lights"),
        Command("Turn the model", "File", turn, "Ctrl+U", enabled=stands,
                tip="another axis points up: y, z, x, -y, -z, -x in turn"),
    ]  # fmt: skip
