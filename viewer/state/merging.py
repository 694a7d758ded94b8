"""What two windows have changed of one set of preferences, put together: neither takes the other's changes back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_ABSENT = object()


def merged(base: Mapping[str, Any], mine: Mapping[str, Any], theirs: Mapping[str, Any]) -> dict[str, Any]:
    """What is stored after `mine` was changed from `base`, while others made `theirs` of it; all as JSON has them.

    What only one side has changed is as that side has it.  Where both have, mappings are merged in turn, what either
    has added to a list is in it, and else mine wins.  What `mine` knows nothing of, as a newer version's fields, stays.
    """
    found = {}
    for name in {**mine, **theirs}:
        values = [side.get(name, _ABSENT) for side in (base, mine, theirs)]
        value = values[2] if name not in mine and name not in base else _merged(*values)
        if value is not _ABSENT:
            found[name] = value
    return found


def _merged(base: Any, mine: Any, theirs: Any) -> Any:
    if mine == base:
        return theirs
    if theirs in (base, mine):
        return mine
    if isinstance(mine, Mapping) and isinstance(theirs, Mapping):
        return merged(base if isinstance(base, Mapping) else {}, mine, theirs)
    if isinstance(mine, list) and isinstance(theirs, list):
        before = base if isinstance(base, list) else []
        names = {_name(item) for item in mine} - {None}
        gone = [item for item in before if item not in theirs]  # taken out by others
        kept = [item for item in mine if item not in gone]
        return kept + [item for item in theirs if item not in before and item not in kept and _name(item) not in names]
    return mine


def _name(item: Any) -> Any:
    """What tells a preset or a bookmark from others."""
    return item.get("name") if isinstance(item, Mapping) else None
