"""How command lines are read: the parser, whose errors are one line that asks what may have been meant, and values.

A function that reads a value raises ValueError in one line.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, TypeVar

from tracer.similar import did_you_mean, similar
from viewer.util.messages import ERROR, say

if TYPE_CHECKING:
    from tracer.experiments.warmup_frames import WarmupFrame
    from tracer.scene.model import Camera
    from viewer.state.views import View

T = TypeVar("T")

FAILED, MISUSED, INTERRUPTED = 1, 2, 130
"""Exit codes where a command fails, where its line is wrong, and where Ctrl-C ended it."""
UPS = ("x", "y", "z", "-x", "-y", "-z")
_A_CAMERA = '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'


class Parser(argparse.ArgumentParser):
    """Options by their whole names; errors in one line, which names where help is."""

    _unknown: Sequence[str] = ()
    """Words of the last command line that are no arguments, about which there is an error."""

    def __init__(self, command: str, description: str, epilog: str) -> None:
        super().__init__(
            prog=f"shadowcull {command}".strip(),
            description=description,
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )

    def parse_known_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:  # type: ignore[override]
        self._unknown = ()
        options, self._unknown = super().parse_known_args(_with_axes(sys.argv[1:] if args is None else args), namespace)
        return options, self._unknown

    def _meant(self) -> str:
        """Ask about the first unknown word that is like an option; its dashes, which all have, do not count."""
        known = [
            name[2:]
            for name, action in self._option_string_actions.items()
            if name.startswith("--") and action.help is not argparse.SUPPRESS
        ]
        words = (word[2:].partition("=")[0] for word in self._unknown if word.startswith("--"))
        found = next(filter(None, (similar(word, known, 0.7) for word in words)), "")
        return f": did you mean '--{found}'?" if found else ""

    def _get_value(self, action: argparse.Action, text: str) -> Any:
        """Say what the function that reads a value says of a wrong one; argparse would say only that it is invalid."""
        try:
            return action.type(text) if callable(action.type) else text
        except ValueError as error:
            raise argparse.ArgumentError(action, str(error)) from None

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError:
            hint = did_you_mean(str(value), map(str, action.choices or ()))
            if not hint:
                raise
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}{hint}") from None

    def error(self, message: str) -> NoReturn:
        say(f"{message}{self._meant()} (see '{self.prog} --help')", ERROR)
        sys.exit(MISUSED)


def _with_axes(arguments: Sequence[str]) -> list[str]:
    """Join `--up -z` to one word: a word that begins with a dash would be taken for an option."""
    found: list[str] = []
    for argument in arguments:
        if found and found[-1] == "--up" and argument in UPS:
            found[-1] = f"--up={argument}"
        else:
            found.append(argument)
    return found


# --- numbers ---------------------------------------------------------------------------------------


def _matched(pattern: str, text: str, wrong: str) -> tuple[str, ...]:
    found = re.fullmatch(pattern, text.strip(), re.ASCII)
    if found is None:
        raise ValueError(f"{text!r} {wrong}")
    return found.groups()


def whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"{text!r} is not a whole number") from None


def count(least: int, most: int) -> Callable[[str], int]:
    """Read a whole number in this range."""

    def parse(text: str) -> int:
        value = whole(text)
        if not least <= value <= most:
            raise ValueError(f"{value} is not in {least} to {most}")
        return value

    return parse


def number(least: float = -math.inf, most: float = math.inf) -> Callable[[str], float]:
    """Read a number in this range."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            raise ValueError(f"{text!r} is not a number") from None
        if not least <= value <= most and (math.isfinite(least) or math.isfinite(most)):
            raise ValueError(f"{text} is not in {least:,.12g} to {most:,.12g}")
        return value

    return parse


def several(parse: Callable[[str], T]) -> Callable[[str], list[T]]:
    """Read values with commas between them."""
    return lambda text: [parse(part.strip()) for part in text.split(",")]


def size(text: str) -> tuple[int, int]:
    """Read a width and a height."""
    wrong = "is not a size; give one like 640x480"
    width, height = map(int, _matched(r"(\d{1,6})[xX×](\d{1,6})", text, wrong))
    if not width or not height:
        raise ValueError(f"{text!r} {wrong}")
    return width, height


def value_range(text: str) -> tuple[float, float]:
    """Read a range of numbers, like 0:12.5."""
    try:
        low, high = (float(word) for word in text.split(":"))
    except ValueError:
        raise ValueError(f"{text!r} is not a range; give one like 0:12.5") from None
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ValueError(f"{text!r} is not a range: the first number must be the smaller one")
    return low, high


def pixel(text: str) -> tuple[int, int]:
    """Read a column and a row."""
    wrong = "is not a pixel; give one like 320,200, counted from the upper left"
    x, y = _matched(r"(\d{1,6}) *, *(\d{1,6})", text, wrong)
    return int(x), int(y)


def frame_span(text: str) -> tuple[int, int]:
    """Read the first and the last of some frames; a single number is both."""
    wrong = "are not frames; give the first and the last, like 0-99, or one"
    first, last = _matched(r"(\d{1,9})(?:-(\d{1,9}))?", text, wrong)
    if int(first) > int(last or first):
        raise ValueError(f"{text!r}: the last frame, {last}, is before the first")
    return int(first), int(last or first)


def crops(text: str) -> tuple[tuple[int, ...], ...]:
    """Read rectangles of pixels with semicolons between them."""
    pattern, wrong = r" *, *".join([r"(\d{1,6})"] * 4), "is not a crop; give x,y,width,height, with ; between several"
    return tuple(tuple(map(int, _matched(pattern, part, wrong))) for part in text.split(";"))


def place(text: str) -> tuple[float, float]:
    """Read a place in a picture, as parts of its width and height."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        x = y = -1.0
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        raise ValueError(f"{text!r} is not a place; give one like 0,1, in parts of the picture")
    return x, y


# --- JSON ------------------------------------------------------------------------------------------


def _json(text: str, start: str, most: int) -> Any:
    """Read JSON, or the file of that name, which holds it, in `most` bytes at most."""
    from tracer.scene.files import read_regular

    name = text[:60]
    try:
        if not text.lstrip().startswith(start):
            text = read_regular(Path(text), most).decode("utf-8")
        return json.loads(text)
    except OSError as error:
        raise ValueError(f"neither JSON nor a file that can be read: {name}: {error.strerror or error}") from None
    except (ValueError, RecursionError):
        raise ValueError(f"{name} is not JSON") from None


def before(text: str) -> tuple[WarmupFrame, ...]:
    """Read the frames that come before."""
    from tracer.experiments import warmup_frames

    return warmup_frames.from_json(_json(text, "[", 1 << 26))


def camera(text: str) -> Camera | None:
    """Read a camera: JSON, a file that holds it, or a saved picture."""
    from tracer.scene.model import Camera
    from viewer.output import capture
    from viewer.services.scene_files import is_capture

    if is_capture(Path(text)):
        return capture.read_camera(Path(text))[1]
    try:
        return Camera.from_json(_json(text, "{", 1 << 20))
    except ValueError as error:
        hint = f"; give a camera like {_A_CAMERA}" if str(error).endswith("is not JSON") else ""
        raise ValueError(f"{error}{hint}") from None


# --- views and methods -----------------------------------------------------------------------------


class ChosenView(NamedTuple):
    """A view, the light it speaks of, the place of a wipe's line, and whether a map of work shows shares."""

    view: View
    light: int = 0
    wipe: float = 0.5
    shares: bool = False


_OTHER_NAMES = {
    "colour": "color",
    "primitives": "primitive",
    "normals": "normal",
    "count": "pixel-count",
    "certificates": "certificate",
}


def view(text: str) -> ChosenView:
    """Read a view with what it takes: occlusion, shadow:2, wipe:0.3, saved:share."""
    from viewer.state.views import View

    name, colon, detail = text.partition(":")
    name = _OTHER_NAMES.get(name, name)
    details = {View.WIPE: r"0|1|[01]?\.\d{1,9}"} | {v: r"\d{1,9}" for v in View if v.of_light}
    details |= {v: "share" for v in View if v.needs_work}
    shown = {View.WIPE: ":PART"} | {v: ":LIGHT" for v in View if v.of_light} | {
        v: "[:share]" for v in View if v.needs_work
    }  # fmt: skip
    forms = {v.value: v.value + shown.get(v, "") for v in View}
    if name not in forms:
        close = _OTHER_NAMES.get(found := similar(name, [*forms, *_OTHER_NAMES]), found)
        hint = f": did you mean {forms[close]}?" if close else f"; the views are {', '.join(forms.values())}"
        raise ValueError(f"{text!r} is not a view{hint}")
    view = View(name)
    if colon and not re.fullmatch(details.get(view, r"(?!)"), detail, re.ASCII):
        raise ValueError(f"{text!r} is not a view; the views are {', '.join(forms.values())}")
    wipe = float(detail) if view is View.WIPE and detail else 0.5
    if wipe > 1.0:
        raise ValueError(f"{text!r}: the line of a wipe lies at 0 to 1 of the width")
    return ChosenView(view, int(detail) if view.of_light and detail else 0, wipe, view.needs_work and bool(detail))


def method(text: str) -> str:
    """Read the name of a method."""
    return methods(text)[0]


def methods(text: str, more: Sequence[str] = ()) -> list[str]:
    """Read names of methods, or others; all that are unknown are named together."""
    from tracer.method import Method, unknown

    wrong, found = [], []
    for name in (part.strip() for part in text.split(",")):
        try:
            found.append(name if name in more else str(Method.parse(name)))
        except ValueError:
            wrong.append(name)
    if wrong:
        said = f"invalid choice: {unknown(wrong)}"
        raise ValueError(said if said.endswith("?") or not more else f"{said}; or {', '.join(more)}")
    return found


def methods_or_all(text: str) -> list[str]:
    """Read names of methods, among them "all"."""
    return methods(text, ("all",))
