"""Frames on request, for `tests.bench.counters`: a process of its own around whichever `tracer` it is given.

    python frame_server.py TREE SCENE SETTINGS     with TREE, a folder that holds `tracer`, first in the path

Prints a line of JSON once it is ready, and then one for each line with a frame's number that it reads:
how long the frame took, also in seconds of all cores, a digest of everything in it, and what it counted.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time as clock
from collections.abc import Iterator
from pathlib import Path
from typing import Any


def digest(frame: Any) -> str:
    """One number for all that a frame shows and all that was learnt from it."""
    made = hashlib.sha256()
    for name in ("color", "depth", "primitive", "normal", "modes", "pixel_count", "highest_count"):
        made.update(getattr(frame, name).tobytes())
    return made.hexdigest()


def serve(tree: Path, scene: str, settings: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """An answer once ready, then one per frame."""
    import tracer

    if not Path(tracer.__file__).is_relative_to(tree):
        raise SystemExit(f"{tracer.__file__} is not the tracer in {tree}")
    try:
        loaded = tracer.load_scene(scene)
    except tracer.SceneError as error:
        raise SystemExit(str(error)) from None
    renderer = tracer.Renderer(loaded, tracer.Settings(**settings))
    renderer.render(loaded.frame_time(0))  # untimed: compiles, and warms caches
    renderer.reset_modes()
    yield {"frames": loaded.frames}
    for line in sys.stdin:
        moment = loaded.frame_time(int(line))
        before, worked = clock.perf_counter(), clock.process_time()
        frame = renderer.render(moment)
        times = {"seconds": clock.perf_counter() - before, "processor_seconds": clock.process_time() - worked}
        yield times | {"digest": digest(frame), "statistics": frame.statistics.to_dict()}


def main() -> None:
    tree, scene, settings = sys.argv[1:]
    for answer in serve(Path(tree), scene, json.loads(settings)):
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
