"""Opens the window as a script does, twice, and prints what its function was given."""

from __future__ import annotations

import sys
from dataclasses import replace

import tracer
import viewer


def main() -> None:
    scene = tracer.load_scene(sys.argv[1])
    seen: list[tracer.Frame] = []

    def look(frame: tracer.Frame) -> bool:
        seen.append(frame)
        return len(seen) < 2

    last = viewer.show(scene, look, method="paper", samples=2)
    assert last is not None and last.settings.method == "paper"
    assert len(seen) == 2 and all(frame.statistics.part == 1.0 for frame in seen)
    made = replace(scene, path=scene.path.with_name("made.aff"), lights=scene.lights[:1])
    last = viewer.show(made, lambda frame: False)
    assert last is not None and last.lights == 1
    print("shown", [frame.color.shape == frame.pixels.shape for frame in seen])


if __name__ == "__main__":
    main()
