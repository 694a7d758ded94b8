"""Open the viewer (`make run`).  Without a display, do its main job into files: a picture, the paper's Figure 1 of it,
and what culling saves along the path."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from viewer.__main__ import main
from viewer.util.messages import say
from viewer.util.resources import DEFAULT_SCENE
from viewer.util.screen import has_display, no_display_reason

PICTURE, FIGURE = "out/first-light.png", "out/figure-1.svg"
SIZE = ("--size", "640x480")


def run(words: list[str]) -> int:
    """Run the viewer with these words of a command line; returns the exit code."""
    if has_display() or "--help" in words:
        return main(words)
    say(f"{no_display_reason()}; rendering to files instead")
    Path(PICTURE).parent.mkdir(exist_ok=True)
    named = words if words and not words[0].startswith("-") else [DEFAULT_SCENE, *words]
    if named[0].endswith(".png"):
        return main(["render", *named, "-o", PICTURE])
    # Three times the same frame: what the first ones teach is what the last one saves.
    files = ("-o", PICTURE, "--figure1", FIGURE, "--method", "paper", "--repeat", "2")
    code = main(["render", *named, *files, *SIZE])
    return code or main(["bench", *named, "--path-frames", "20", "--accelerator", "bvh8", *SIZE])


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
