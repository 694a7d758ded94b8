"""The pictures of the pages of the paper and of methods, by the command line: `make pictures ARGS=methods`, or

    python tools/method_pictures.py [NAME ...]

Each is what one method knows, or does, in a scene that comes with the program."""

from __future__ import annotations

import io
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from PIL import Image

from viewer.cli.main import main as command

ASSETS = Path(__file__).resolve().parent.parent / "assets"
SIZE = ["--size", "400x250"]
QUALITY = 80
STUDY = "default --frame 56 --warmup 4"
LAMPS = "office --frame 60 --lightcuts-error 0.1"
CLOSE = "--lamp-radius 0.5 --lamp-samples 64"
FIGURE_3 = "figure3 --size 9x9"
ENLARGED = 30  # times, what has fewer pixels than this across
# The pictures of each file, beside each other: scene, moment, method and view.
PICTURES = {
    "paper/modes": [f"{STUDY} --view occlusion", f"{STUDY} --view shadow:1"],
    "paper/occlusion": [
        f"{FIGURE_3} --view color",
        f"{FIGURE_3} --view occlusion",
        f"{FIGURE_3} --view occlusion --symmetric",
    ],
    "paper/fates": [f"{STUDY} --view color", f"{STUDY} --view fate:1"],
    "methods/none": [f"{STUDY} --method none --view color", f"{STUDY} --method none --view cost"],
    "methods/paper": [f"{STUDY} --method paper --view shadow:1", f"{STUDY} --method paper --view difference --verify"],
    "methods/cells": [f"{STUDY} --method cells --view shadow:1", f"{STUDY} --method cells --view difference --verify"],
    "methods/auto": [f"{STUDY} --method auto --view color", f"{STUDY} --method certified --view saved:share"],
    "methods/voxels": [f"{STUDY} --method voxels --view certificate:0", f"{STUDY} --method voxels --view cost:share"],
    "methods/lie": [
        f"{STUDY} --method lie-exact --view certificate:1",
        f"{STUDY} --method lie --view difference --verify",
    ],
    "methods/lightcuts": [f"{LAMPS} --method {method} --view cuts" for method in ("lightcuts", "lightcuts-certified")],
    "methods/lightcuts-noise": [
        f"default --frame 56 {CLOSE} --lightcuts-error 0.5 --method {method} --view color"
        for method in ("lightcuts", "lightcuts-stochastic")
    ],
}


def main(names: list[str]) -> int:
    """Make the pictures of these names, or all."""
    if not set(names) <= set(PICTURES):
        print(f"method_pictures: give any of {', '.join(PICTURES)}", file=sys.stderr)
        return 2
    for folder in ("paper", "methods"):
        (ASSETS / folder).mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in names or PICTURES:
            parts = []
            for number, words in enumerate(PICTURES[name]):
                path = Path(folder) / f"{number}.png"
                with redirect_stdout(io.StringIO()):
                    code = command(["render", *SIZE, *words.split(), "-o", str(path)], lambda *_: 1)
                if code:
                    return code
                part = Image.open(path).convert("RGB")
                scale = ENLARGED if part.width < ENLARGED else 1
                parts.append(part.resize((scale * part.width, scale * part.height), Image.Resampling.NEAREST))
            width, height = parts[0].size
            whole = Image.new("RGB", (len(parts) * width + 8 * (len(parts) - 1), height), "white")
            for number, part in enumerate(parts):
                whole.paste(part, (number * (width + 8), 0))
            whole.save(ASSETS / f"{name}.webp", quality=QUALITY, method=6)
            print(f"{ASSETS / name}.webp")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
