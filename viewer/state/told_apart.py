"""Two names in little room: what is the same in both is shortened, so that one sees what is not."""

from __future__ import annotations

from collections.abc import Callable

_GAP = "..."


def told_apart(name: str, other: str, fits: Callable[[str], bool]) -> str:
    """The name, or as much of it as fits; what it has in common with the beginning of the other goes first, from its
    end, then what both end with, then the end of what is left."""
    if fits(name):
        return name
    alike = next((n for n, pair in enumerate(zip(name, other, strict=False)) if pair[0] != pair[1]), None)
    same = name[: min(len(name), len(other)) if alike is None else alike]
    same = same[: max(same.rfind(mark) + 1 for mark in " ,+") if len(same) < len(name) else 0]  # whole words
    rest = name[len(same) :]
    for kept in range(len(same) - 1, -1, -1) if same else ():
        if fits(same[:kept].rstrip() + _GAP + rest):
            return same[:kept].rstrip() + _GAP + rest
    front = _GAP if same else ""
    for end in range(len(rest) - 1, 0, -1):
        if fits(front + rest[:end].rstrip() + _GAP):
            return front + rest[:end].rstrip() + _GAP
    return front + rest[:1]
