"""Arrows, boxes and words on a picture: what they are, and as JSON.

Places are parts of the picture's width and height from its upper left corner, so that they hold at any size.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from viewer.util.json_numbers import number

MOST = 200
LONGEST_TEXT = 200


class Kind(StrEnum):
    """What can be drawn."""

    ARROW = "arrow"
    BOX = "box"
    TEXT = "text"


@dataclass(frozen=True)
class Annotation:
    """An arrow from (x0, y0) to its head at (x1, y1), a box between these corners, or words that begin at (x0, y0)."""

    kind: Kind
    x0: float
    y0: float
    x1: float = 0.0
    y1: float = 0.0
    text: str = ""

    def to_json(self) -> dict[str, Any]:
        return asdict(self) | {"kind": self.kind.value}


def from_json(data: Any) -> tuple[Annotation, ...]:
    """The inverse of a list of `to_json`; raises ValueError, in one line, on anything else."""
    if not isinstance(data, Sequence) or isinstance(data, str) or len(data) > MOST:
        raise ValueError(f"annotations are a list of {MOST} at most")
    return tuple(_one(item) for item in data)


def _one(data: Any) -> Annotation:
    if not isinstance(data, Mapping) or data.get("kind") not in set(Kind):
        raise ValueError(f"an annotation needs a kind: {', '.join(Kind)}")
    try:
        x0, y0, x1, y1 = (number(data.get(name, 0.0)) for name in ("x0", "y0", "x1", "y1"))
    except ValueError:
        raise ValueError("an annotation's x0, y0, x1 and y1 are numbers") from None
    if not all(math.isfinite(place) and -1.0 <= place <= 2.0 for place in (x0, y0, x1, y1)):
        raise ValueError("an annotation's x0, y0, x1 and y1 are parts of the picture, from 0 to 1")
    text = str(data.get("text", ""))
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"an annotation's text has {LONGEST_TEXT} letters at most")
    return Annotation(Kind(data["kind"]), x0, y0, x1, y1, text)
