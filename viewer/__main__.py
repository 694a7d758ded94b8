"""The `shadowcull` command, and `python -m viewer`: the command line, and the window that it opens.

This is the one place that knows both.  The window and all that it brings along (GL, ImGui) are imported only when it is
opened, so that pictures and numbers can be had on machines without a screen or a GL library."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from viewer import window_module

if TYPE_CHECKING:
    from tracer.scene.mesh_options import MeshOptions


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, that of the process by default; returns the exit code."""
    try:
        from viewer.cli import main as command_line  # takes a second or two, in which somebody may cancel
    except KeyboardInterrupt:
        print("shadowcull: cancelled", file=sys.stderr)
        return 130
    return command_line.main(sys.argv[1:] if arguments is None else arguments, _open_window)


def _open_window(scene: Path | None, settings: dict[str, Any], folders: Sequence[Path], meshes: MeshOptions) -> int:
    return int(window_module().App(scene, settings, folders, meshes).run())


if __name__ == "__main__":
    sys.exit(main())
