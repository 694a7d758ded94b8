"""Numbers of JSON that others wrote: whole ones of any length, NaN, infinities, or none at all."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any


def number(value: Any) -> float:
    """A number as a float, which may be NaN or infinite; raises ValueError on anything else, and where it is too large
    for a float."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError("a number in it is damaged")
    try:
        return float(value)
    except OverflowError:
        raise ValueError("a number in it is too large") from None


def finite(value: Any) -> float:
    """A finite number as a float; raises ValueError on anything else."""
    found = number(value)
    if not math.isfinite(found):
        raise ValueError("a number in it is not finite")
    return found


def whole(value: Any) -> int:
    """A whole number; raises ValueError on anything else, also on 1.0 and on true."""
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise ValueError("a whole number in it is damaged")
    return int(value)
