"""The command `info`: what a scene holds."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from tracer.scene.load import load_scene, scene_info
from viewer.cli.console import print_table, working
from viewer.util.messages import say


def info(path: Path, as_json: bool, folders: Sequence[Path] = ()) -> None:
    """Print what a scene holds; raises SceneError."""
    with working() as work:
        scene = load_scene(path, work.progress, folders)
    facts = scene_info(scene)
    print(json.dumps(facts, indent=2)) if as_json else print_table(_facts_table(path, facts))


def _facts_table(path: Path, facts: dict[str, Any]) -> Table:
    table = Table(title=str(path), title_justify="left", title_style="bold", show_header=False)
    table.add_column()
    table.add_column(justify="right")
    for name, value in facts.items():
        if name in ("bounds", "time", "warnings", "light_kinds"):
            continue
        table.add_row(name.replace("_", " "), f"{value:,}")
        if name == "lights":
            for alike in facts["light_kinds"]:
                table.add_row(f"  {_light_kind(alike)}", f"{alike['lights']:,}")
    table.add_row("time", "{:g} to {:g} s".format(*facts["time"]))
    if facts["bounds"] is not None:
        for name, corner in zip(("least corner", "greatest corner"), facts["bounds"]):
            table.add_row(name, "  ".join(f"{x:.4g}" for x in corner))
    for warning in facts["warnings"]:
        say(f"warning: {warning}")
    return table


def _light_kind(alike: dict[str, Any]) -> str:
    """What lights that are alike are, in a few words."""
    samples = f", {alike['samples']} sample{'s' * (alike['samples'] > 1)}" if alike["kind"] != "point" else ""
    falloff = f", falloff {alike['falloff']}" if alike["falloff"] != "none" else ""
    return f"{alike['kind']}{samples}{falloff}"
