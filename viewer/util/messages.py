"""Messages to people, each in one line, and exceptions as such."""

from __future__ import annotations

import sys
import traceback
from dataclasses import dataclass

from tracer.scene.model import SceneError
from tracer.util.text import printable

ERROR = "error: "
LONGEST = 2000
"""Characters of a line; of a longer one the middle is left out."""


def in_one_line(text: object) -> str:
    line = printable(" ".join(str(text).split()))
    return line if len(line) <= LONGEST else f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"


def say(message: object, kind: str = "") -> None:
    """One line on standard error, of a kind such as "error: "."""
    print(f"shadowcull: {kind}{in_one_line(message)}", file=sys.stderr, flush=True)


# --- exceptions -------------------------------------------------------------------------------------

KNOWN = (SceneError, ValueError, OSError, MemoryError)
"""Kinds of errors whose one line speaks of a file, a value, a disk or memory."""


@dataclass(frozen=True)
class Failure:
    """`expected` says that the line is all there is to know: nothing in the program is wrong."""

    text: str
    details: str
    expected: bool


def failure(error: BaseException, what: str = "", known: tuple[type[BaseException], ...] = KNOWN) -> Failure:
    """An exception, with what failed by it in front; of a kind that is `known` to happen, it is expected."""
    line = one_line(error)
    details = "" if isinstance(error, SceneError) else "".join(traceback.format_exception(error))
    return Failure(f"{what}: {line}" if what else line, details, isinstance(error, known))


def one_line(error: BaseException) -> str:
    """An exception as one line for the status bar; the kind is named unless the message speaks for itself."""
    text = in_one_line(error)
    if isinstance(error, OSError) and error.errno and error.strerror:  # whose own text begins with "[Errno 36]"
        text = in_one_line(f"{error.filename}: {error.strerror}" if error.filename else error.strerror)
    if isinstance(error, MemoryError):
        return "out of memory" + (f": {text}" if text else "")
    if isinstance(error, SceneError | ValueError | OSError) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
