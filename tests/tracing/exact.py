"""Vectors in exact arithmetic, for judges that must not round."""

from __future__ import annotations

from collections.abc import Iterable

Exact = list[int]


def exact(*vectors: Iterable[float]) -> list[Exact]:
    """Vectors times the same power of two, which makes them whole; fractions would be reduced at every step."""
    ratios = [[float(x).as_integer_ratio() for x in vector] for vector in vectors]
    scale = max(below for vector in ratios for _, below in vector)
    return [[above * (scale // below) for above, below in vector] for vector in ratios]


def minus(a: Exact, b: Exact) -> Exact:
    """The difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a: Exact, b: Exact) -> Exact:
    """The cross product of two vectors."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Exact, b: Exact) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
