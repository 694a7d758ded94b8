"""Words that people type as values; on other words, each raises argparse.ArgumentTypeError, in one line."""

from __future__ import annotations

import argparse
import json
import math
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from viewer.state.plans import parse_factors

if TYPE_CHECKING:
    from tracer.experiments.warmup_frames import WarmupFrame
    from viewer.state.draw_options import Slice
    from viewer.state.tone import Curve
    from viewer.state.views import View

T = TypeVar("T")

_VIEW_NAMES = {
    "colour": "color",
    "primitives": "primitive",
    "normals": "normal",
    "count": "pixel-count",
    "certificates": "certificate",
}


def size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text.strip())
    if not match or not int(match[1]) or not int(match[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size; give one like 640x480")
    return int(match[1]), int(match[2])


def count(least: int, most: int) -> Callable[[str], int]:
    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number") from None
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{value} is not in {least} to {most}")
        return value

    return parse


def number(least: float, most: float) -> Callable[[str], float]:
    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not in {least:,.12g} to {most:,.12g}")
        return value

    return parse


def values(text: str) -> tuple[float, float]:
    """A range of numbers, like 0:12.5."""
    try:
        low, high = (float(word) for word in text.split(":"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a range; give one like 0:12.5") from None
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise argparse.ArgumentTypeError(f"{text!r} is not a range: the first number is to be the smaller")
    return low, high


def curve(text: str) -> Curve:
    from viewer.state.tone import Curve

    try:
        return Curve(text.strip().lower())
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no tone; there is {', '.join(Curve)}") from None


def several(parse: Callable[[str], T]) -> Callable[[str], list[T]]:
    """Values with commas between them."""
    return lambda text: [parse(part.strip()) for part in text.split(",")]


def pixel(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6}) *, *(\d{1,6})", text.strip(), re.ASCII)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not a pixel; give one like 320,200, counted from the upper left")
    return int(match[1]), int(match[2])


def span(text: str) -> tuple[int, int]:
    """The first and the last of some frames; a single number is both."""
    match = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text.strip(), re.ASCII)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} are not frames; give the first and the last, like 0-99, or one")
    first, last = int(match[1]), int(match[2] or match[1])
    if first > last:
        raise argparse.ArgumentTypeError(f"{text!r}: the last frame, {last}, is before the first")
    return first, last


def crops(text: str) -> tuple[tuple[int, int, int, int], ...]:
    """Rectangles of pixels with semicolons between them."""
    found = []
    for part in text.split(";"):
        match = re.fullmatch(r" *(\d{1,6}) *, *(\d{1,6}) *, *(\d{1,6}) *, *(\d{1,6}) *", part, re.ASCII)
        if not match:
            raise argparse.ArgumentTypeError(f"{part!r} is not a crop; give x,y,width,height, with ; between several")
        found.append((int(match[1]), int(match[2]), int(match[3]), int(match[4])))
    return tuple(found)


def tev_address(text: str) -> tuple[str, int]:
    """Where tev listens."""
    from viewer.output.tev import address

    try:
        return address(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def place(text: str) -> tuple[float, float]:
    """A place in a picture, in parts of its width and height."""
    x, comma, y = text.partition(",")
    try:
        at = float(x), float(y)
    except ValueError:
        at = -1.0, -1.0
    if not comma or not all(0.0 <= part <= 1.0 for part in at):
        raise argparse.ArgumentTypeError(f"{text!r} is not a place; give one like 0,1, in parts of the picture")
    return at


def before(text: str) -> tuple[WarmupFrame, ...]:
    """Frames before, as JSON, or a file that holds it."""
    from tracer.experiments import warmup_frames
    from tracer.scene.files import read_regular

    try:
        if not text.lstrip().startswith("["):
            text = read_regular(Path(text), 1 << 26).decode("utf-8")
        return warmup_frames.from_json(json.loads(text))
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{text[:60]!r}: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise argparse.ArgumentTypeError(f"not understood: {error}") from None


def factors(text: str) -> list[float]:
    try:
        return parse_factors(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


class ChosenView(NamedTuple):
    """A view, the light it speaks of, the place of a wipe's line, and whether a map of work shows shares."""

    view: View
    light: int = 0
    wipe: float = 0.5
    shares: bool = False


def view(text: str) -> ChosenView:
    """A view with what it takes: occlusion, shadow:2, wipe:0.3, saved:share."""
    from viewer.state.views import View

    name, colon, detail = text.partition(":")
    name = _VIEW_NAMES.get(name, name)
    details = {View.WIPE: r"0|1|[01]?\.\d{1,9}"} | {v: r"\d{1,9}" for v in View if v.of_light}
    details |= {v: "share" for v in View if v.needs_work}
    shown = {View.WIPE: ":PART"} | {
        v: ":LIGHT" if v.of_light else "[:share]" for v in View if v.of_light or v.needs_work
    }
    forms = {v.value: v.value + shown.get(v, "") for v in View}
    if name not in forms:
        from tracer.similar import similar

        close = _VIEW_NAMES.get(found := similar(name, [*forms, *_VIEW_NAMES]), found)
        hint = f": did you mean {forms[close]}?" if close else f"; the views are {', '.join(forms.values())}"
        raise argparse.ArgumentTypeError(f"{text!r} is not a view{hint}")
    if colon and not re.fullmatch(details.get(View(name), r"(?!)"), detail, re.ASCII):
        raise argparse.ArgumentTypeError(f"{text!r} is not a view; the views are {', '.join(forms.values())}")
    view = View(name)
    wipe = float(detail) if view is View.WIPE and detail else 0.5
    if wipe > 1.0:
        raise argparse.ArgumentTypeError(f"{text!r}: the line of a wipe lies at 0 to 1 of the width")
    return ChosenView(view, int(detail) if view.of_light and detail else 0, wipe, view.needs_work and bool(detail))


def slice_(text: str) -> Slice:
    """An axis and a place along it: x:0.5."""
    from viewer.state.draw_options import AXES, MIDDLE, Slice

    axis, colon, at = text.partition(":")
    if (
        axis not in AXES
        or (colon and not re.fullmatch(r"0|1|[01]?\.\d{1,30}", at, re.ASCII))
        or (colon and float(at) > 1)
    ):
        raise argparse.ArgumentTypeError(f"{text!r} is no slice; give an axis and 0 to 1 along it, like y:0.3")
    return Slice(AXES.index(axis), float(at) if colon else MIDDLE.at)


def cube_side(text: str) -> int:
    """Cells along an edge of a light's cube."""
    if not re.fullmatch(r"\d{1,9}", text, re.ASCII) or int(text) not in (16, 32, 64, 128, 256, 512, 1024):
        raise argparse.ArgumentTypeError(f"{text!r} is no power of two from 16 to 1024")
    return int(text)


def lamp_samples(text: str) -> int:
    """The number of points from which a lamp shines."""
    from tracer.scene.lights import MAX_SAMPLES

    return count(1, MAX_SAMPLES)(text)


def method(text: str) -> str:
    """The name of a method."""
    return _methods([text])[0]


def methods(text: str) -> list[str]:
    """Names of methods; all that are none are named together."""
    return _methods([part.strip() for part in text.split(",")])


def methods_or_all(text: str) -> list[str]:
    """Names of methods, among them "all"."""
    names = [part.strip() for part in text.split(",")]
    try:
        found = iter(_methods([name for name in names if name != "all"]))
    except argparse.ArgumentTypeError as error:
        known = str(error).endswith("?")
        raise argparse.ArgumentTypeError(f"{error}" if known else f"{error}; or all") from None
    return [name if name == "all" else next(found) for name in names]


def _methods(names: Sequence[str]) -> list[str]:
    from tracer.method import Method, unknown

    wrong, found = [], []
    for name in names:
        try:
            found.append(str(Method.parse(name)))
        except ValueError:
            wrong.append(name)
    if wrong:
        raise argparse.ArgumentTypeError(f"invalid choice: {unknown(wrong)}")
    return found


class BeyondMemory(argparse.Action):
    """An option that says it to all readers of scenes, also those in other processes, by the environment."""

    def __call__(self, *_: object) -> None:
        os.environ["SHADOWCULL_BEYOND_MEMORY"] = "1"
