"""How command lines are read: the parser, whose errors are one line that asks what may have been meant, and values.

A function that reads a value raises ValueError in one line."""

from __future__ import annotations

import argparse
import math
import re
import sys
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from tracer.experiments import warmup_frames
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.method import Method, unknown
from tracer.scene.camera import Camera
from tracer.scene.files import read_regular
from tracer.scene.limits import LARGEST
from tracer.util.setting import Setting
from tracer.util.suggest import similar
from viewer.state.codec import from_text
from viewer.state.draw_options import DrawOptions
from viewer.state.views import Record, View
from viewer.util.messages import ERROR, say

T = TypeVar("T")

FAILED, MISUSED, INTERRUPTED = 1, 2, 130
"""Exit codes where a command fails, where its line is wrong, and where Ctrl-C ended it."""
UPS = ("x", "y", "z", "-x", "-y", "-z")
CAMERA = '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'


class Parser(argparse.ArgumentParser):
    """Options by their whole names; errors in one line, which names where help is."""

    def __init__(self, command: str, description: str, epilog: str) -> None:
        super().__init__(
            prog=f"shadowcull {command}".strip(),
            description=textwrap.fill(description, 100),
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        self._negative_number_matcher = re.compile(r"-\.?\d|-[xyz]$")  # words that are values: -3, and -z of --up

    def _get_value(self, action: argparse.Action, text: str) -> Any:
        """Say what the function that reads a value says of a wrong one; argparse would say only that it is invalid."""
        try:
            return action.type(text) if callable(action.type) else text
        except ValueError as error:
            raise argparse.ArgumentError(action, str(error)) from None

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help or a version; argparse would say nothing of a disk that is full."""
        print(message, end="", file=file or sys.stderr, flush=True)

    def error(self, message: str) -> NoReturn:
        """Ask about the first unknown word that is like an option; its dashes, which all have, do not count."""
        known = [name[2:] for name, action in self._option_string_actions.items() if action.help != argparse.SUPPRESS]
        unknown = re.findall(r" --([\w-]+)", message) if message.startswith("unrecognized arguments") else []
        meant = next(filter(None, (similar(word, known, 0.7) for word in unknown)), "")
        hint = f": did you mean '--{meant}'?" if meant else ""
        say(f"{message}{hint} (see '{self.prog} --help')", ERROR)
        sys.exit(MISUSED)


# --- numbers ---------------------------------------------------------------------------------------


def count(least: float = -math.inf, most: float = math.inf) -> Callable[[str], int]:
    """Read a whole number in this range."""
    return Setting("", "", least, most, kind=int).parse


def number(least: float = -math.inf, most: float = math.inf) -> Callable[[str], float]:
    """Read a number in this range."""
    return Setting("", "", least, most, kind=float).parse


def _form(
    pattern: str, kind: type, wanted: str, right: Callable[..., bool] = lambda *_: True
) -> Callable[[str], tuple[Any, ...]]:
    """Read numbers in a pattern, where N is a whole number and X any, that are `right`; else it says what is wanted."""
    pattern = pattern.replace("N", r"(\d{1,9})").replace("X", r"([-+]?\d*\.?\d+(?:e[-+]?\d+)?)")

    def parse(text: str) -> tuple[Any, ...]:
        found = re.fullmatch(pattern, "".join(text.lower().split()), re.ASCII)
        numbers = tuple(kind(part) for part in found.groups() if part is not None) if found else ()
        if not numbers or not right(*numbers):
            raise ValueError(f"{text!r} is not {wanted}")
        return numbers

    return parse


size = _form("N[x×]N", int, "a size; give one like 640x480", lambda *sides: min(sides) > 0)
pixel = _form("N,N", int, "a pixel; give one like 320,200, counted from the upper left")
value_range = _form(
    "X:X", float, "a range; give the smaller number and the larger one, like 0:12.5", lambda low, high: low < high
)
place = _form(
    "X,X", float, "a place; give one like 0,1, in parts of the picture", lambda x, y: 0 <= min(x, y) <= max(x, y) <= 1
)
_span = _form(
    "N(?:-N)?", int, "a range of frames; give the first and the last, like 0-99, or one",
    lambda first, last=math.inf: first <= last,
)  # fmt: skip
light_at = _form(
    "N=X,X,X", float, f"a light and a place within {LARGEST:g} of the origin; give them like 2=1.5,3,-0.5",
    lambda light, *place: max(map(abs, place)) <= LARGEST,
)  # fmt: skip
_crop = _form("N,N,N,N", int, "a crop; give x,y,width,height, with ; between several")


def frame_span(text: str) -> tuple[int, int]:
    """Read the first and the last of some frames; a single number is both."""
    found = _span(text)
    return found[0], found[-1]


def crops(text: str) -> tuple[tuple[int, ...], ...]:
    """Read rectangles of pixels with semicolons between them."""
    return tuple(map(_crop, text.split(";")))


# --- JSON ------------------------------------------------------------------------------------------


def _json(text: str, start: str, most: int) -> Any:
    """Read JSON, or the file of that name, which holds it, in `most` bytes at most."""
    name = text[:60]
    try:
        if not text.lstrip().startswith(start):
            text = read_regular(Path(text), most).decode("utf-8")
        return from_text(text)
    except OSError as error:
        raise ValueError(f"neither JSON nor a file that can be read: {name}: {error.strerror or error}") from None
    except ValueError:
        raise ValueError(f"{name} is not JSON") from None


def before(text: str) -> tuple[WarmupFrame, ...]:
    """Read the frames that come before."""
    return warmup_frames.from_json(_json(text, "[", 1 << 26))


def camera(text: str) -> Camera:
    """Read a camera: JSON, a file that holds it, or a saved picture."""
    if text.lower().endswith(".png"):
        from viewer.output import capture

        return capture.read_camera(Path(text))[1]
    try:
        return Camera.from_json(_json(text, "{", 1 << 20))
    except ValueError as error:
        hint = f"; give a camera like {CAMERA}" if str(error).endswith("is not JSON") else ""
        raise ValueError(f"{error}{hint}") from None


# --- views and methods -----------------------------------------------------------------------------


def view_form(view: View) -> str:
    """Return a view as it is given, with what it takes: shadow:LIGHT, wipe:PART, saved:share."""
    shares = "[:share]" if view.records is Record.WORK else ""
    takes = ":LIGHT" if view.of_light else ":PART" if view is View.WIPE else shares
    return view.value + takes


def view(text: str) -> DrawOptions:
    """Read a view with what it takes: occlusion, shadow:2, wipe:0.3, saved:share."""
    name, colon, detail = text.partition(":")
    found = next((view for view in View if view.value == name), None)
    if found is None:
        close = similar(name, list(View))
        hint = f": did you mean {view_form(View(close))}?" if close else f"; the views are {', '.join(View)}"
        raise ValueError(f"{text!r} is not a view{hint}")
    chosen, why = DrawOptions(found), ""
    try:
        if not colon:
            return chosen
        if found.of_light:
            return replace(chosen, light=count(0, 2**31 - 1)(detail))
        if found is View.WIPE:
            return replace(chosen, wipe=number(0.0, 1.0)(detail))
        if found.records is Record.WORK and detail == "share":
            return replace(chosen, shares=True)
    except ValueError as error:
        why = f": {error}"
    raise ValueError(f"{text!r} is not a view; give {view_form(found)}{why}")


def method(text: str) -> str:
    """Read the name of a method."""
    (found,) = methods(text.replace(",", ";"))  # which no method has in its name
    return found


def methods(text: str, more: Sequence[str] = ()) -> list[str]:
    """Read names of methods, or others; all that are unknown are named together."""
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
