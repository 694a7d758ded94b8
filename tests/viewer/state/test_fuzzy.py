"""What a few letters find."""

from __future__ import annotations

import pytest

from viewer.state.fuzzy import match, nearly

NAMES = ["Occlusion mode", "Shadow mode", "Colour", "Next light", "Light theme", "Command palette", "Add bookmark"]


def best(typed: str) -> str:
    found = [(m.score, name) for name in NAMES if (m := match(typed, name)) is not None]
    return max(found)[1]


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("occ", "Occlusion mode"), ("mode sh", "Shadow mode"), ("om", "Occlusion mode"), ("light", "Light theme"),
        ("n li", "Next light"), ("book", "Add bookmark"), ("abk", "Add bookmark"), ("CPAL", "Command palette"),
    ],
)  # fmt: skip
def test_what_is_meant_comes_first(typed: str, meant: str):
    assert best(typed) == meant


def test_letters_that_are_not_there_find_nothing():
    assert match("xyz", "Occlusion mode") is None and match("mode x", "Shadow mode") is None
    assert match("oue", "Occlusion mode") is None, "letters here and there are no match"


def test_places_are_those_of_the_letters():
    assert match("mo occ", "Occlusion mode").places == (0, 1, 2, 10, 11)
    assert match("om", "Occlusion mode").places == (0, 10)


def test_words_elsewhere_count_for_less_and_a_whole_word_for_most():
    assert match("view", "Colour", "View").score < match("view", "Next view").score
    assert match("light", "Light theme").score > match("light", "Lighter").score
    assert match("default", "default").score > match("default", "Default layout").score + 19.0, "the name itself"
    assert match("vw", "Colour", "View") is None, "elsewhere words are meant as they are"


def test_a_slip_of_the_hand_is_nearly_right():
    assert nearly("oclusion", "Occlusion mode") > 0.8 and nearly("shadwo mdoe", "Shadow mode") > 0.0
    assert nearly("zebra", "Occlusion mode") == 0.0
