"""The command `info`: what a scene's file holds, and what a studio adds to it."""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from tracer.scene.load import load_scene, scene_info
from tracer.scene.mesh_options import IN_STUDIO
from tracer.scene.meshes import MESH_EXTENSIONS
from tracer.scene.model import Scene
from tracer.scene.studio import FLOOR_TRIANGLES, LAMPS, up_in_studio
from viewer.cli import pictures
from viewer.cli.arguments import Parser
from viewer.cli.console import Work, print_table, titled, working
from viewer.cli.options import add_scene
from viewer.util.messages import say

EPILOG = """\
examples:
  shadowcull info kitchen.aff
  shadowcull info default --json
"""


def parser() -> Parser:
    description = (
        "Say what a scene, or that of a saved picture, holds: primitives, lights, materials, frames, bounds, and "
        "warnings. Of a model without camera and lights it counts what is in the file, lit by two lights, and says "
        "what the studio adds in the window and in pictures."
    )
    parser = Parser("info", description, EPILOG)
    add_scene(parser)
    parser.add_argument("--json", action="store_true", help="as JSON on standard output")
    return parser


def run(options: Namespace) -> int:
    """Print what a scene holds; raises SceneError."""
    path, folders = pictures.scene_of(options.path), options.folder
    with working() as work:
        scene = load_scene(path, work.progress, folders)
        studio = {"triangles": FLOOR_TRIANGLES, "lights": LAMPS} if _gets_studio(scene, work, folders) else None
    facts = scene_info(scene) | {"studio": studio}
    if options.json:
        print(json.dumps(facts, indent=2))
        return 0
    print_table(_table(path, facts))
    if studio is not None:
        print(
            f"in the window and in pictures, a studio adds {FLOOR_TRIANGLES} triangles, and {LAMPS} lamps in place of "
            "these lights; --no-studio leaves it out"
        )
    return 0


def _gets_studio(scene: Scene, work: Work, folders: Sequence[Path]) -> bool:
    """Whether the window, and what traces, set this scene in a studio."""
    ending = scene.path.suffix.lower()
    if ending not in MESH_EXTENSIONS or not scene.triangle_count:
        return False
    may_have_its_own = ending in (".gltf", ".glb")  # the others know neither cameras nor lights
    return not may_have_its_own or up_in_studio(load_scene(scene.path, work.progress, folders, IN_STUDIO)) is not None


def _table(path: Path, facts: dict[str, Any]) -> Table:
    table = titled(str(path))
    table.show_header = False
    table.add_column()
    table.add_column(justify="right")
    for name, value in facts.items():
        if isinstance(value, int):
            table.add_row(name.replace("_", " "), f"{value:,}")
        for alike in facts["light_kinds"] if name == "lights" else ():
            samples = f", {alike['samples']} sample{'s' * (alike['samples'] > 1)}" if alike["kind"] != "point" else ""
            falloff = f", falloff {alike['falloff']}" if alike["falloff"] != "none" else ""
            table.add_row(f"  {alike['kind']}{samples}{falloff}", f"{alike['lights']:,}")
    table.add_row("time", "{:g} to {:g} s".format(*facts["time"]))
    for name, corner in zip(("least corner", "greatest corner"), facts["bounds"] or ()):
        table.add_row(name, "  ".join(f"{x:.4g}" for x in corner))
    for warning in facts["warnings"]:
        say(f"warning: {warning}")
    return table
