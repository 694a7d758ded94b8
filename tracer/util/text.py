"""Numbers and names as people read them, in results, in the window and on the command line alike."""

from __future__ import annotations

import shlex
from bisect import bisect_left
from collections.abc import Callable, Sequence

MOST_PERCENT = 10.0
"""Parts of a whole past which something is so many times as many, as nobody reads -119360 %."""


def printable(text: object) -> str:
    """Escape control characters, and what no writing has, so that nothing in a text commands a terminal."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(text))


def shell_line(words: Sequence[str]) -> str:
    """Return words as a shell takes them, and with nothing in them that a terminal obeys."""
    return " ".join(shlex.quote(word) if word.isprintable() else f"$'{''.join(map(_escaped, word))}'" for word in words)


def _escaped(letter: str) -> str:
    """A letter between $' and ', by its code where it cannot be seen; of a byte that is no text the byte."""
    if letter in "\\'":
        return f"\\{letter}"
    code = ord(letter)
    if letter.isprintable():
        return letter
    return f"\\x{code & 0xFF:02x}" if code < 0x80 or 0xDC80 <= code <= 0xDCFF else f"\\U{code:08x}"


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


def wrapped(text: str, measure: Callable[[str], float], width: float) -> list[str]:
    """A text in lines that are no wider than that; a word that is too long by itself is broken where it must be."""
    lines = [""]
    for word in text.split():
        if measure(longer := f"{lines[-1]} {word}".strip()) <= width:
            lines[-1] = longer
            continue
        fits = 1  # letters: twice as many as long as they fit, so that no long part is measured often
        while fits < len(word):
            if measure(word[: 2 * fits]) <= width:
                fits *= 2
                continue
            fits += bisect_left(range(fits + 1, 2 * fits), True, key=lambda letters: measure(word[:letters]) > width)
            lines.append(word[:fits])
            word, fits = word[fits:], 1
        lines.append(word)
    return list(filter(None, lines))
