"""Messages to people, each in one line."""

from __future__ import annotations

import sys

ERROR = "error: "


def printable(text: object) -> str:
    """A text in which nothing commands a terminal: control characters, and what no writing has, are escaped."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(text))


def in_one_line(text: object) -> str:
    return printable(" ".join(str(text).split()))


def say(message: object, kind: str = "") -> None:
    """One line on standard error, of a kind such as "error: "."""
    print(f"shadowcull: {kind}{in_one_line(message)}", file=sys.stderr, flush=True)
