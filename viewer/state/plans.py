"""What the user plans to measure: an experiment over a path, a zoom test towards a primitive."""

from __future__ import annotations

from dataclasses import dataclass

MOST_FACTORS = 6  # that are compared in one zoom test


@dataclass
class ExperimentPlan:
    """What to measure: `frames` over the whole path, by each of `methods`, the reference always among them, through a
    tree whose steps are the paper's unless another is chosen."""

    methods: set[str]
    frames: int = 100
    size: tuple[int, int] = (512, 512)
    depth: int = 10
    verify: bool = False
    accelerator: str = "kdtree"


@dataclass
class ZoomPlan:
    """How to go towards a primitive: in `steps`, each to `ratio` of the distance, once with each of `factors`, which
    are as they were typed; with `same_start` from where the last test began, if that is known."""

    factors: str = "4, 16"
    steps: int = 30
    ratio: float = 0.94
    size: tuple[int, int] = (256, 256)
    same_start: bool = False


def frames_within(first: int, last: int | None, count: int) -> tuple[int, int]:
    """The first and the last frame of a plan, its end where `last` is None, of a path of `count` frames."""
    end = count - 1
    first = min(max(first, 0), end)
    return first, end if last is None else min(max(last, first), end)


@dataclass
class FilmPlan:
    """What to film: the frames `first` to `last` of the path, to its end where that is None, with the scene's camera or
    `from_here`, or a flight `through_bookmarks`; `seconds` long, 0 for every frame once."""

    through_bookmarks: bool = False
    first: int = 0
    last: int | None = None
    from_here: bool = False
    seconds: float = 0.0
    fps: float = 25.0
    size: tuple[int, int] = (640, 480)
    samples: int = 1
    caption: str = ""
    legend: bool = False
    video: bool = False


@dataclass
class HuntPlan:
    """What to search for wrong pixels of a method: the frames `first` to `last` of the path, to its end where that is
    None, every `step`-th, and so many pictures `around` the worst finds, as far as `radius` and `seed` say; the worst
    `keep` are kept."""

    method: str = "paper"
    first: int = 0
    last: int | None = None
    step: int = 1
    around: int = 40
    radius: float = 0.3
    seed: int = 1
    keep: int = 12
    size: tuple[int, int] = (256, 256)


MOST_MULTIPLE = 8


@dataclass
class PicturePlan:
    """A picture to be traced and saved: so many times as wide and high as the window's, as a file of an `ending`; the
    fields of the `caption` are those of names."""

    multiple: int = 2
    samples: int = 16
    legend: bool = False
    caption: str = ""
    ending: str = ".png"


def parse_factors(text: str) -> list[float]:
    """Zoom factors, from words like "4, 16", each once, MOST_FACTORS at most; raises ValueError in one line."""
    try:
        factors = list(dict.fromkeys(float(word) for word in text.replace(",", " ").split()))
    except ValueError:
        factors = []
    if not factors or not all(1.0 <= factor <= 1e6 for factor in factors):
        raise ValueError(f"{text!r} are not zoom factors; give numbers from 1 up, like 4,16")
    if len(factors) > MOST_FACTORS:
        raise ValueError(f"these are {len(factors)} zoom factors; give {MOST_FACTORS} at most")
    return factors
