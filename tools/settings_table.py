"""Writes `docs/settings.md`: all settings, from their declarations."""

from __future__ import annotations

import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tracer.util.setting import Setting, settings_of  # noqa: E402
from viewer.state.preferences import Preferences  # noqa: E402
from viewer.state.view_state import ViewState  # noqa: E402

PAGE = ROOT / "docs" / "settings.md"
HEAD = """# Settings

These are the settings of the tracer (`settings`, in Python `tracer.Settings`), of how frames are drawn (`draw`), of how
the window traces (`pace`), and of the user (the others). An option sets the same on the [command
line](command-line.md). `make settings` writes this table from the declarations.

| setting | what it does | values | default | option |
|---|---|---|---|---|
"""


def page() -> str:
    """Return the page."""
    return HEAD + "".join(_row(one) for one in (*settings_of(ViewState), *settings_of(Preferences)))


def _row(one: Setting) -> str:
    default = one.default or one.unset if one.kind is str else one.text(one.default)
    default = "" if default == "changed" else default
    values = one.expected_shown if one.kind in (bool, int, float) or one.choices else ""
    if one.kind is float and one.default == math.inf:
        default = "no limit"
    option = f"`{one.option}`" if one.option else ""
    return f"| {one.label} (`{one.path}`) | {one.help} | {values} | {default} | {option} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
