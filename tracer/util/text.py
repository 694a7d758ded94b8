"""Numbers and names as people read them, in results, in the window and on the command line alike."""

from __future__ import annotations

MOST_PERCENT = 10.0
"""Parts of a whole past which something is so many times as many, as nobody reads -119360 %."""


def printable(text: object) -> str:
    """Escape control characters, and what no writing has, so that nothing in a text commands a terminal."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(text))


def mode_in_words(name: str) -> str:
    """Return the name of a mode, such as NON_SHADOW, as people read it: non-shadow."""
    return name.lower().replace("_", " ").replace("non shadow", "non-shadow")


def saved(part: float, spread: float | None = None) -> str:
    """Return which part of some work is saved, and how much that varies: 41.2%, 41.2% ± 1.2; where more than ten times
    as much is done instead, how many times: 1,194 × as many."""
    if part < -MOST_PERCENT:
        varies = "" if spread is None else f" ± {_times(spread)}"
        return f"{_times(1.0 - part)}{varies} × as many"
    return f"{part:.1%}" + ("" if spread is None else f" ± {100.0 * spread:.1f}")


def _times(number: float) -> str:
    return f"{number:,.1f}" if number < 100.0 else f"{number:,.0f}"
