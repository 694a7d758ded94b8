"""A picture to the desktop's clipboard, by the program that the desktop has for that."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

_PROGRAMS = {
    "wl-copy": ("WAYLAND_DISPLAY", ["--type", "image/png"]),
    "xclip": ("DISPLAY", ["-selection", "clipboard", "-target", "image/png", "-in"]),
}
NONE = "the picture cannot be copied: install xclip, or wl-clipboard where the desktop is Wayland"


def program(environment: Mapping[str, str] | None = None) -> list[str] | None:
    """The command that takes a PNG on its standard input; None where there is none."""
    environment = os.environ if environment is None else environment
    for name, (display, options) in _PROGRAMS.items():
        found = shutil.which(name, path=environment.get("PATH"))
        if found and environment.get(display):
            return [found, *options]
    return None


def copy(png: bytes) -> None:
    """Put a PNG there; raises OSError in one line.

    The program is spawned, not forked: a copy of this process, with its window and its threads, is none to go on in."""
    command = program()
    if command is None:
        raise OSError(NONE)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        file.write_bytes(png)
        actions = [
            (os.POSIX_SPAWN_OPEN, 0, str(file), os.O_RDONLY, 0),
            (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
            (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
        ]
        process = os.posix_spawn(command[0], command, os.environ, file_actions=actions)
        _, status = os.waitpid(process, 0)  # both go on in the background by themselves
    code = os.waitstatus_to_exitcode(status)
    if code:
        raise OSError(f"the picture was not copied: {Path(command[0]).name} failed with code {code}")
