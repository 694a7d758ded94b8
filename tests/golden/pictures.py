"""The golden pictures: what the embedded scenes looked like when somebody last looked.

    make golden     renders them anew, says what changed, and keeps what is the same

Each is a frame after a few before it, so that culling has something to go by, in the views of colour,
occlusion modes and shadow modes.  Two processors may differ in the last bit of a ray, and then, where
an edge or a shadow passes right through a pixel's centre, in that pixel, and in rare cases in the mode
of a primitive.  A picture is therefore the same as its golden one if no more than `Golden.stray` pixels
differ by more than one level of 255 in any channel, and the mean of every channel by at most half a
level.  Corners moved by one float32 rounding each stay within half of that; a light moved by 1 cm does
not (tests/test_golden.py shows both).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tests.viewer.drawn import picture
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Scene
from viewer.output.light_cube import by_depths, by_lists
from viewer.state.draw_options import MIDDLE, Slice
from viewer.state.views import LIGHT_CUBES, View
from viewer.util.resources import embedded_scenes

FOLDER = Path(__file__).resolve().parent
SETTINGS = Settings(width=160, height=120)
MEAN = 0.5  # levels by which the mean of a channel may differ
AMPLIFIED = 8  # times, in a picture of differences


@dataclass(frozen=True)
class Golden:
    """A frame of an embedded scene, after the frames from `first` on, in the views of modes of some lights and in those
    of `fates` of the first of them; `stray` pixels may differ."""

    name: str
    scene: str
    first: int
    last: int
    lights: tuple[int, ...]
    stray: int
    fates: tuple[View, ...] = ()

    def frame(self, scene: Scene, settings: Settings = SETTINGS, world: World | None = None) -> Frame:
        """The frame, rendered with modes learnt in the frames before it; world as in `Renderer`."""
        renderer = Renderer(scene, replace(settings, record_fates=bool(self.fates)), world=world)
        for number in range(self.first, self.last + 1):
            frame = renderer.render(scene.frame_time(number))
        return frame

    def views(self, frame: Frame) -> Iterator[tuple[str, NDArray[np.uint8]]]:
        """Name of the file, without its ending, and picture (height, width, 3) of each view."""
        yield f"{self.name}-color", picture(frame, View.COLOR)
        yield f"{self.name}-occlusion", picture(frame, View.OCCLUSION)
        for light in self.lights:
            yield f"{self.name}-shadow-{light}", picture(frame, View.SHADOW, light)
        for view in self.fates:
            yield f"{self.name}-{view.value}", picture(frame, view, self.lights[0])


GOLDEN = (
    Golden(
        "default", "default", 20, 28, (0, 3), stray=57, fates=(View.FATE, View.MOVING_SHADOW)
    ),  # 0.3 % of the pixels
    Golden("figure3", "figure3", 0, 1, (0, 1), stray=4),
    Golden("figure4-before-zooming", "figure4", 0, 20, (0,), stray=2),  # its shadow is not known of
    Golden("figure4", "figure4", 0, 40, (0,), stray=2),
)


@dataclass(frozen=True)
class OfMethod:
    """A view of what a method keeps of a scene, or its plain picture, in the first frame; `stray` pixels may differ."""

    name: str
    scene: str
    method: str
    view: View
    stray: int
    cut: Slice = MIDDLE
    memory: float = SETTINGS.certificate_memory

    def frame(self, world: World | None = None) -> Frame:
        """The frame; `world` as in `Renderer`."""
        scene = load_scene(embedded_scenes()[self.scene]) if world is None else world.scene
        settings = replace(SETTINGS, method=self.method, certificate_memory=self.memory)
        renderer = Renderer(scene, settings, world=world)
        return renderer.render(scene.frame_time(0))

    def picture(self, frame: Frame) -> NDArray[np.uint8]:
        """(height, width, 3)."""
        return picture(frame, self.view, slice=self.cut)


EXACT = "figure3-exact"
OF_METHODS = (
    OfMethod("default-voxels", "default", "voxels", View.VOXELS, stray=60, cut=Slice(1, 0.2), memory=16.0),
    OfMethod("default-cell-lights", "default", "lie-exact", View.CELL_LIGHTS, stray=60),
    *(OfMethod(EXACT, "figure3", method, View.COLOR, stray=4) for method in ("voxels", "lie-exact", "lightbuffer")),
)


def light_cube() -> NDArray[np.uint8]:
    """What the first light of the third figure sees: what is known of its cells, and where shadow begins."""
    scene = load_scene(embedded_scenes()["figure3"])
    renderer = Renderer(scene, Settings(width=8, height=8, method="lightbuffer", light_buffer_side=64, threads=2))
    cube = renderer.render().structures[LIGHT_CUBES][0].cube
    assert cube is not None
    lists, depths = by_lists(cube, "").picture, by_depths(cube).picture
    gap = np.broadcast_to(lists[0, 0], (len(lists), 4, 3))
    return np.concatenate([lists, gap, depths], axis=1)


@dataclass(frozen=True)
class Difference:
    """How a picture differs from the golden one: pixels off by more than one level, the most that any
    channel is off, and the most that the mean of a channel is off, in levels of 255."""

    pixels: int
    most: int
    mean: float

    @staticmethod
    def between(golden: NDArray[np.uint8], made: NDArray[np.uint8]) -> Difference:
        """Of two pictures (height, width, 3); raises ValueError where their sizes differ."""
        if golden.shape != made.shape:
            raise ValueError(f"the golden picture is {golden.shape[1]} x {golden.shape[0]} pixels, this one is not")
        off = made.astype(np.int32) - golden
        pixels = int((np.abs(off).max(axis=2) > 1).sum())
        return Difference(pixels, int(np.abs(off).max()), float(np.abs(off.mean(axis=(0, 1))).max()))

    def tolerated(self, stray: int) -> bool:
        """Whether last bits may be all that it is."""
        return self.pixels <= stray and self.mean <= MEAN

    def __str__(self) -> str:
        return f"{self.pixels} pixels differ by more than one level, by up to {self.most}; the mean by {self.mean:.3f}"


def golden_picture(name: str) -> NDArray[np.uint8] | None:
    """The golden picture (height, width, 3) of that name, if there is one."""
    path = FOLDER / f"{name}.png"
    return np.asarray(Image.open(path).convert("RGB")) if path.exists() else None


def fault(name: str, made: NDArray[np.uint8], stray: int, folder: Path) -> str | None:
    """What is wrong with a picture, if anything is.  Then it, and its differences from the golden one,
    amplified, are written to the folder."""
    golden = golden_picture(name)
    if golden is None:
        return f"there is no golden picture {name}; make golden makes it"
    difference = Difference.between(golden, made)
    if difference.tolerated(stray):
        return None
    folder.mkdir(parents=True, exist_ok=True)
    new, amplified = folder / f"{name}.png", folder / f"{name}-difference.png"
    Image.fromarray(made).save(new)
    off = np.abs(made.astype(np.int32) - golden) * AMPLIFIED
    Image.fromarray(np.minimum(off, 255).astype(np.uint8)).save(amplified)
    return (
        f"{name}: {difference} (stray pixels allowed: {stray})\n"
        f"  golden     {FOLDER / name}.png\n  now        {new}\n  difference {amplified}, {AMPLIFIED} times\n"
        "  If this is how it must look from now on: make golden, look at every picture, commit them."
    )


def _renew(name: str, made: NDArray[np.uint8], stray: int) -> str:
    """Write a golden picture unless it is there and the same; what was done."""
    golden, path = golden_picture(name), FOLDER / f"{name}.png"
    if golden is None or golden.shape != made.shape:
        Image.fromarray(made).save(path, optimize=True)
        return "new" if golden is None else "new, of another size"
    difference = Difference.between(golden, made)
    if np.array_equal(golden, made):
        return "the same"
    if difference.tolerated(stray):
        return f"kept; within the tolerance: {difference}"
    Image.fromarray(made).save(path, optimize=True)
    return f"CHANGED: {difference}"


def main() -> int:
    """Renew the golden pictures, and say what changed."""
    scenes, written = embedded_scenes(), set()
    for golden in GOLDEN:
        for name, made in golden.views(golden.frame(load_scene(scenes[golden.scene]))):
            print(f"{name}.png: {_renew(name, made, golden.stray)}")
            written.add(f"{name}.png")
    for of in OF_METHODS:
        print(f"{of.name}.png, by {of.method}: {_renew(of.name, of.picture(of.frame()), of.stray)}")
        written.add(f"{of.name}.png")
    print(f"light-cube.png: {_renew('light-cube', light_cube(), 60)}")
    written.add("light-cube.png")
    for path in sorted(FOLDER.glob("*.png")):
        if path.name not in written:
            path.unlink()
            print(f"{path.name}: removed; no scene makes it any longer")
    return 0


if __name__ == "__main__":
    sys.exit(main())
