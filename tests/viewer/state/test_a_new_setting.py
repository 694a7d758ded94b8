"""A setting is declared in one line, and everything else there is of it follows."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BEFORE = "    outlines: bool = setting("
LINE = '    sparkle: bool = setting(False, "Sparkle", "Let light sparkle.", option="--sparkle", panel="View")\n'
SEEN = """
import runpy
from types import SimpleNamespace
from viewer.cli import pictures, render
from viewer.output import commands
from viewer.state import codec, view_state
from viewer.state.view_state import ViewState
from viewer.window import setting_rows

state, shown = ViewState(scene="/a.aff"), ViewState(scene="/a.aff").with_draw(sparkle=True)
changed = []
session = SimpleNamespace(state=state, animated=False, scene=None)
settings = SimpleNamespace(set=lambda one, value: changed.append((one.path, value)))
runs = SimpleNamespace(current=None)
ui = SimpleNamespace(controller=SimpleNamespace(session=session, settings=settings, runs=runs, preferences=None),
                     commands=[])
ui.controller.preferences = setting_rows.Preferences()

assert "draw.sparkle" in [one.path for one in setting_rows.in_panel(ui, "View")], "the panel"
(entry,) = [item for item in setting_rows.entries(ui) if item.label == "Sparkle"]
entry.run()
assert changed == [("draw.sparkle", True)] and not entry.is_checked, "the palette"
assert "let light sparkle" in render.parser().format_help(), "the help of the command line"
given = render.parser().parse_args(["a.aff", "-o", "a.png", "--sparkle"])
assert given.sparkle is True and "sparkle" in [one.name for one in pictures.DRAWN], "its options"
assert "--sparkle" in commands.words(shown, None, "a.png"), "the command that is copied"
stored = codec.state_to_json(shown, of_picture=True)
assert stored["draw"]["sparkle"] is True and codec.state_from_json(stored).draw.sparkle, "a saved picture"
assert codec.recalled(codec.remembered(shown)).draw.sparkle, "the next window"
assert view_state.changes(state, shown) == {"draw.sparkle": "sparkle on"}, "undo"
assert "| Sparkle (`draw.sparkle`) | Let light sparkle. |" in runpy.run_path("tools/settings_table.py")["page"]()
print("seen everywhere")
"""


def test_a_setting_is_one_line(tmp_path: Path) -> None:
    for folder in ("viewer", "tools"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    declared = tmp_path / "viewer" / "state" / "draw_options.py"
    text = declared.read_text(encoding="utf-8")
    assert text.count(BEFORE) == 1
    declared.write_text(text.replace(BEFORE, LINE + BEFORE), encoding="utf-8")
    here = {**os.environ, "PYTHONPATH": os.pathsep.join((str(tmp_path), str(ROOT)))}
    done = subprocess.run([sys.executable, "-c", SEEN], cwd=tmp_path, env=here, capture_output=True, text=True)
    assert done.stdout == "seen everywhere\n", done.stderr
