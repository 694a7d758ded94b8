"""Two windows change one set of preferences."""

from __future__ import annotations

import pytest

from viewer.state.preferences import merged

A, B, C, D = ({"name": name, "state": {}} for name in "ABCD")


@pytest.mark.parametrize(
    ("base", "mine", "theirs", "wanted"),
    [
        ({"depth": 1, "theme": "dark"}, {"depth": 2, "theme": "dark"}, {"depth": 1, "theme": "light"}, (2, "light")),
        ({"depth": 1, "theme": "dark"}, {"depth": 2, "theme": "dark"}, {"depth": 3, "theme": "dark"}, (2, "dark")),
    ],
)
def test_what_one_has_changed_stays_and_the_last_one_wins(base, mine, theirs, wanted):
    assert tuple(merged(base, mine, theirs).values()) == wanted


def test_lists_have_what_either_has_added_and_lack_what_either_has_taken_out():
    found = merged({"marks": [A, B]}, {"marks": [A, B, C]}, {"marks": [B, D]})
    assert found == {"marks": [B, C, D]}
    renamed = {**A, "name": "A2"}
    assert merged({"marks": [A]}, {"marks": [renamed]}, {"marks": [A, B]}) == {"marks": [renamed, B]}


def test_mappings_are_merged_and_what_nobody_here_knows_stays():
    found = merged({"marks": {}}, {"marks": {"room": [A]}}, {"marks": {"hall": [B]}, "of a newer version": 7})
    assert found == {"marks": {"room": [A], "hall": [B]}, "of a newer version": 7}
    assert merged({"last": {"a": 1}}, {"last": {}}, {"last": {"a": 1}}) == {"last": {}}
