"""The scene: what is in it, what its reader warns of, and how to open another."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.scene.model import Scene
from viewer.state.methods import remark_on
from viewer.util.resources import embedded_scenes
from viewer.window import menus
from viewer.window.command import Command, Kind
from viewer.window.panels import lights
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import QUIET, WARNING, clipped, count, heading, paragraph, properties, value, wide_button


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    if wide_button(f"{icons.ICON_FA_FOLDER_OPEN}  Open...", f"or drop a file on the window{ui.key('Open...')}", 2):
        ui.open(Dialog.OPEN_FILE)
    imgui.same_line()
    if wide_button(f"{icons.ICON_FA_CUBES}  Scenes", "those that come with the program, and recent ones"):
        imgui.open_popup("scenes")
    if imgui.begin_popup("scenes"):
        menus.show_menu(ui, "File/Open scene", commands(ui))
        imgui.end_popup()
    if c.session.scene is None:
        paragraph("No scene is open.", QUIET)
        return
    _facts(ui, c.session.scene)
    _lights(ui, c.session.scene)
    _warnings(c.session.scene)


def commands(ui: Ui) -> list[Command]:
    """Return what opens the scenes that come with the program, and those that were open last."""
    loader, own = ui.controller.loader, embedded_scenes()
    recent = [path for path in map(Path, ui.controller.preferences.recent) if path not in own.values()]
    scenes = [(name, path, "comes with Shadowcull") for name, path in own.items()]
    scenes += [(path.name, path, str(path.parent)) for path in recent]
    return [
        Command(f"scene {path}", "File/Open scene", partial(loader.open, path), title=name, kind=Kind.SCENE, tip=where,
                separated=bool(recent) and path == recent[0])
        for name, path, where in scenes
    ]  # fmt: skip


def _facts(ui: Ui, scene: Scene) -> None:
    info, (start, end) = ui.controller.info, scene.time_range
    facts = [
        ("File", scene.path.name, str(scene.path)),
        ("Triangles", count(info.get("triangles", 0)), ""),
        ("  dynamic", count(info.get("dynamic_triangles", 0)),
         "of objects that move: their shadow rays are never culled"),
        ("Spheres, cones", f"{count(info.get('spheres', 0))}, {count(info.get('cones', 0))}", ""),
        ("Objects", f"{len(scene.objects) - 1} dynamic" if len(scene.objects) > 1 else "all static", ""),
        ("Materials", f"{len(scene.materials)}, {len(scene.textures)} textures", ""),
        *([("Animation", f"{scene.frames} frames, {end - start:.4g} s", "")] if ui.controller.session.animated else []),
    ]  # fmt: skip
    with properties("facts", 7.0) as shown:
        for fact in facts if shown else ():
            value(*fact)


def _lights(ui: Ui, scene: Scene) -> None:
    number, settings = len(scene.lights), ui.controller.session.settings
    heading(f"Lights ({count(number)})")
    if not number:
        paragraph("No lights: only ambient light shows, and there are no shadows to cull.", WARNING)
        return
    said = ui.cached("what the method leaves", scene, settings, lambda: remark_on(scene.lights, settings))
    if said:
        paragraph(f"{icons.ICON_FA_TRIANGLE_EXCLAMATION} {said}", WARNING)
    lights.table(ui)


def _warnings(scene: Scene) -> None:
    if not scene.warnings:
        return
    heading(f"Warnings ({len(scene.warnings)})")
    if imgui.begin_child("warnings", (0.0, min(len(scene.warnings), 6) * imgui.get_text_line_height_with_spacing())):
        for warning in scene.warnings:
            clipped(warning.replace(f"{scene.path.parent}/", ""), WARNING)
    imgui.end_child()
