"""Names of methods: what culls shadow rays, and what it takes along, joined by "+"."""

from __future__ import annotations

BASES = ("none", "paper", "cells", "certified", "auto")
EXTRAS = ("cache", "rest")
_BY_MODES = ("paper", "cells")


def base_of(method: str) -> str:
    """What culls: "paper" of "paper+cache"."""
    return method.split("+")[0]


def takes(method: str, extra: str) -> bool:
    """Whether a method takes an extra along."""
    return extra in method.split("+")[1:]


def culls_by_modes(method: str) -> bool:
    """Whether a method culls by the modes of the paper: it keeps them in any case, and may be wrong.  All others are
    exact: their pictures are the same, bit for bit."""
    return base_of(method) in _BY_MODES


def certifies(method: str) -> bool:
    """Whether a method makes certificates, or may make some."""
    return base_of(method) not in ("none", *_BY_MODES)


def is_method(name: str) -> bool:
    """Whether there is such a method: a base, then any extras, each once."""
    base, *extras = name.split("+")
    return base in BASES and all(extra in EXTRAS for extra in extras) and len(set(extras)) == len(extras)


def choice() -> str:
    """What there is to choose from, in words."""
    return f"one of {', '.join(BASES)}, which may be followed by {' and '.join('+' + extra for extra in EXTRAS)}"
