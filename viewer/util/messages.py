"""Messages to people, each in one line."""

from __future__ import annotations

import sys

ERROR = "error: "


def in_one_line(text: object) -> str:
    return " ".join(str(text).split())


def say(message: object, kind: str = "") -> None:
    """One line on standard error, of a kind such as "error: "."""
    print(f"shadowcull: {kind}{in_one_line(message)}", file=sys.stderr, flush=True)
