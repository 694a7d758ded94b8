"""Vectors in exact arithmetic: lists of three fractions, for judges that must not round."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

Exact = list[Fraction]


def exact(values: Iterable[float]) -> Exact:
    """Numbers as they are in binary."""
    return [Fraction(float(x)) for x in values]


def minus(a: Exact, b: Exact) -> Exact:
    """The difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a: Exact, b: Exact) -> Exact:
    """The cross product of two vectors."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Exact, b: Exact) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
