"""What is planned to be traced: an experiment over a path, a zoom test, a film, a hunt, a picture to be saved.

Fields that are settings of the tracer go by their declarations there."""

from __future__ import annotations

from dataclasses import dataclass

from tracer.experiments.camera_path import MOST_FRAMES
from tracer.geometry.accelerators import KD_TREE
from tracer.scene.model import Scene
from tracer.settings import Settings
from tracer.util.setting import setting

MOST_ZOOM_FACTORS = 6
LONGEST_RUN_SIDE = 4096
"""Pixels of a run's pictures, of which there are many."""
MOST_PICTURE_PIXELS = 1 << 26
"""8192 x 8192: a frame's buffers then take some 4 GB."""


def parse_factors(text: str) -> list[float]:
    """Zoom factors, from words like "4, 16", each once, MOST_ZOOM_FACTORS at most; raises ValueError in one line."""
    try:
        factors = list(dict.fromkeys(float(word) for word in text.replace(",", " ").split()))
    except ValueError:
        factors = []
    if not factors or not all(1.0 <= factor <= 1e6 for factor in factors):
        raise ValueError(f"{text!r} are not zoom factors; give numbers from 1 up, like 4,16")
    if len(factors) > MOST_ZOOM_FACTORS:
        raise ValueError(f"these are {len(factors)} zoom factors; give {MOST_ZOOM_FACTORS} at most")
    return factors


@dataclass
class ExperimentPlan:
    """A path of frames by each of `methods`, the reference always among them, through a tree whose steps are the
    paper's unless another is chosen."""

    methods: set[str]
    frames: int = setting(100, "Frames", "Frames over the whole path of the scene.", low=1, high=MOST_FRAMES)
    size: tuple[int, int] = setting((Settings.width, Settings.height), "Size", "Size of the pictures.",
                                    high=LONGEST_RUN_SIDE)  # fmt: skip
    depth: int = Settings.depth
    accelerator: str = KD_TREE
    verify: bool = False


@dataclass
class ZoomPlan:
    """Towards a primitive in `steps`, each to `ratio` of the distance, once with each of `factors`, as they were
    typed."""

    factors: str = setting(
        "4, 16", "Factors",
        "Zoom factors to compare: a primitive is examined anew once it covers this many times the pixels of its last "
        "examination.", check=parse_factors, option="--factors",
    )  # fmt: skip
    steps: int = setting(30, "Steps", "Steps towards the primitive.", low=1, high=10_000, option="--steps")
    ratio: float = setting(
        0.94, "Ratio", "The part of the distance that is left after each step.", low=0.001, high=0.9999,
        slider=(0.5, 0.99), digits=2, option="--ratio",
    )  # fmt: skip
    size: tuple[int, int] = setting(
        (256, 256), "Size", "Size of the pictures: it decides the pixel counts, and what can be seen from afar.",
        high=LONGEST_RUN_SIDE,
    )  # fmt: skip


@dataclass
class PathPlan:
    """The frames `first` to `last` of the path, to its end where that is None."""

    first: int = 0
    last: int | None = None

    def frames(self, scene: Scene | None) -> tuple[int, int]:
        """Return the first and the last of them, of those that there are."""
        end = scene.frames - 1 if scene is not None else 0
        first = min(max(self.first, 0), end)
        return first, end if self.last is None else min(max(self.last, first), end)


@dataclass
class FilmPlan(PathPlan):
    """Frames of the path, with the scene's camera or `from_here`, or a flight `through_bookmarks`; 0 seconds for every
    frame once."""

    through_bookmarks: bool = False
    from_here: bool = False
    seconds: float = setting(
        0.0, "Seconds", "Length of the film; 0 for every frame once, or 2 seconds from bookmark to bookmark.",
        low=0.0, high=86_400.0, digits=1, option="--seconds",
    )  # fmt: skip
    fps: float = setting(25.0, "Frames / s", "Frames a second of the video.", low=1.0, high=240.0, digits=2,
                         option="--fps")  # fmt: skip
    size: tuple[int, int] = setting((640, 480), "Size", "Size of the pictures.", high=LONGEST_RUN_SIDE)
    samples: int = 1
    caption: str = setting("", "Caption", "A line below each picture.", unset="none")
    legend: bool = setting(False, "Legend", "Draw what the colours mean, in views that have any.")
    video: bool = setting(False, "Video", "Write an mp4 as well, beside the numbered pictures.")


@dataclass
class HuntPlan(PathPlan):
    """Frames of the path, by a method whose wrong pixels are searched; the worst `keep` are kept."""

    method: str = "paper"
    step: int = setting(1, "Step", "Search only every nth of these frames.", low=1, high=MOST_FRAMES,
                        option="--step")  # fmt: skip
    around: int = setting(40, "Extra views", "Extra random views near the worst findings.", low=0,
                          high=MOST_FRAMES, option="--around")  # fmt: skip
    radius: float = setting(
        0.3, "Radius", "How far extra views are from a finding's camera, as a part of its distance to what is wrong.",
        low=0.0, high=100.0, slider=(0.0, 1.0), digits=2, option="--radius",
    )  # fmt: skip
    seed: int = setting(1, "Seed", "Seed of the extra views.", low=0, high=2**31 - 1, option="--seed")
    keep: int = setting(12, "Findings", "How many of the worst findings are kept.", low=1, high=1000, option="--keep")
    size: tuple[int, int] = setting(
        (256, 256), "Size", "Size of the pictures: modes are those of a size.", high=LONGEST_RUN_SIDE
    )


@dataclass
class PicturePlan:
    """A picture to be traced and saved: so many times as wide and high as the window's, as a file of an `ending`; the
    fields of the `caption` are those of names."""

    multiple: int = setting(2, "Size", "Times the width and the height of the picture as it is now.", low=1,
                            high=8, unit=" x")  # fmt: skip
    samples: int = 16
    ending: str = setting(
        ".png", "Format", "The kind of file.",
        choices={
            ".png": "remembers how it was made, and can be checked",
            ".exr": "linear colours with all buffers, and how it was made; without legend and caption",
            ".jpg": "small; forgets how it was made",
        },
    )  # fmt: skip
    legend: bool = setting(False, "Legend", "Draw what the colours mean, in views that have any.")
    caption: str = setting("", "Caption", "A line below the picture.", unset="none")
