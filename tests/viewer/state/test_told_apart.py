"""Names that begin alike, in little room."""

from __future__ import annotations

import pytest

from viewer.state.told_apart import told_apart


@pytest.mark.parametrize(
    ("name", "other", "room", "shown"),
    [
        ("paper", "certified", 9, "paper"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 24, "certified+cache, frame 3"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 16, "certified+ca...3"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 6, "ce...3"),
        ("certified+cache", "certified+rest", 10, "ce...cache"),
        ("certified+cache", "certified", 8, "certi..."),
        ("certified+cache, depth 10", "certified+cache, depth 2", 5, "...10"),
        ("certified, frame 3", "certified, depth 3, frame 3", 12, "ce...frame 3"),
        ("certified", "certified", 6, "cer..."),
        ("certified", "paper", 6, "cer..."),
    ],
)
def test_what_differs_is_seen(name: str, other: str, room: int, shown: str) -> None:
    found = told_apart(name, other, lambda text: len(text) <= room)
    assert found == shown and len(found) <= room
