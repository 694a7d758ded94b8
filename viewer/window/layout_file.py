"""The file of where the panels are: the old one or the new one, whole."""

from __future__ import annotations

import json
import os
import re
from contextlib import ExitStack, suppress
from pathlib import Path

from viewer.util.files import part_file, part_name

LAYOUT_FILE = "layout.ini"
END = ";;;<<<SplitIds>>>;;;"
"""What Hello ImGui writes last of the layout, with JSON in the line after it; words of ours may follow."""


class LayoutFile:
    """ImGui writes a copy of its own, which takes the file's name when the window is closed, if it is whole."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / LAYOUT_FILE
        self.working_copy = part_name(self.path)  # where none can be made: nobody reads or writes it
        self._file = ExitStack()
        with suppress(OSError):  # then the layout is not remembered; saving the settings says why
            folder.mkdir(parents=True, exist_ok=True)
            self.working_copy, file = self._file.enter_context(part_file(self.path))
            text = self.path.read_text(encoding="utf-8", errors="replace")
            if is_whole(text):
                file.write(text.encode())
                file.flush()

    def put_window(self, place: tuple[int, int, int, int] | None) -> None:
        """Let the window begin next time at this left, top, width and height, where Hello ImGui has written the place
        of one that was full or maximised."""
        with suppress(OSError):
            text = self.working_copy.read_text(encoding="utf-8", errors="replace")
            if place is not None and is_whole(text):
                x, y, width, height = place
                for name, value in (("Position", f"{x},{y}"), ("Size", f"{width},{height}")):
                    text = re.sub(rf"^Window{name}=.*$", f"Window{name}={value}", text, count=1, flags=re.MULTILINE)
                self.working_copy.write_text(text, encoding="utf-8")

    def keep(self) -> None:
        """Let what ImGui has written take the place of what was there."""
        with self._file, suppress(OSError):
            if is_whole(self.working_copy.read_text(encoding="utf-8", errors="replace")):
                with self.working_copy.open("rb") as file:
                    os.fsync(file.fileno())
                os.replace(self.working_copy, self.path)


def is_whole(text: str) -> bool:
    """Whether a layout was written to its end: on a full disk ImGui writes as much as there is room for."""
    found = re.search(rf"^{END}\s*^(.*)$", text, re.MULTILINE)
    try:
        return found is not None and isinstance(json.loads(found[1]), dict)
    except ValueError:
        return False
