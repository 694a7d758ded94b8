"""Names of methods, and what they can do."""

import re

import pytest

from tracer.method import Kind, Method, additions, bases, choice, meant, register, title_of, unregister
from viewer.state.methods import with_base


def test_a_name_gives_a_base_additions_and_capabilities():
    method = Method.parse("certified+cache+rest")
    assert (method.base, method.additions, str(method)) == ("certified", ("cache", "rest"), "certified+cache+rest")
    assert method.exact and method.has_certificates and method.culls and not method.uses_modes
    assert method.has("cache") and not method.has("certified")
    assert Method.parse("cells").uses_cells and Method.parse("auto").adaptive
    assert not Method.parse("none+rest").culls and Method.parse("none+cache").culls
    assert {kind.name for kind in bases() if not kind.exact} == {
        "paper",
        "cells",
        "lie",
        "lightcuts",
        "lightcuts-stochastic",
        "lightcuts-certified",
    }


@pytest.mark.parametrize(
    "name", ["", "paperr", "cache", "paper+", "paper+none", "paper+cache+cache", "+cache", "Paper"]
)
def test_other_names_are_refused_in_one_line_that_says_what_there_is(name):
    with pytest.raises(ValueError, match=re.escape(f"no method {name!r}")) as error:
        Method.parse(name)
    said = str(error.value)
    assert "\n" not in said
    if meant(name):
        assert said.endswith("?") and "one of" not in said
    else:
        assert "it is one of none, paper" in said
        assert all(f"+{kind.name}" in said for kind in additions(measures=True))


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("certfied", "certified"),
        ("Paper", "paper"),
        ("certified+cahe", "certified+cache"),
        ("none+packet16", "none+packets16"),
        ("cache", "none+cache"),
        ("paper+cache+cache", "paper+cache"),
        ("paper+none", ""),
        ("telepathy", ""),
    ],
)
def test_what_may_have_been_meant_is_asked(name: str, found: str):
    assert meant(name) == found
    if found:
        with pytest.raises(ValueError, match=f"did you mean '{re.escape(found)}'"):
            Method.parse(name)


def test_what_stands_alone_is_a_base_and_an_addition_but_not_both_at_once():
    kind = register(Kind("mine", "Mine.", dict, addition=True, alone=True))
    try:
        assert kind in bases() and kind in additions() and kind not in additions("mine")
        assert (Method.parse("mine+cache").base, Method.parse("paper+mine").additions) == ("mine", ("mine",))
        with pytest.raises(ValueError, match=r"no method 'mine\+mine'"):
            Method.parse("mine+mine")
        assert with_base("paper+mine+cache", "mine") == "mine+cache"
    finally:
        unregister("mine")


def test_a_kind_is_registered_once_and_can_be_taken_back():
    before = bases(), additions(), choice()
    with pytest.raises(ValueError, match="already"):
        register(Kind("paper", "", object))
    kind = register(Kind("mine", "Mine.", dict))
    assert Method.parse("mine+rest").kind is kind and kind.load() is dict
    unregister("mine")
    assert (bases(), additions(), choice()) == before
    with pytest.raises(ValueError, match="no method 'mine'"):
        Method.parse("mine")


def test_people_read_titles_each_of_one_kind_and_names_where_there_is_none():
    kinds = {*bases(measures=True), *additions(measures=True)}
    assert len({kind.title for kind in kinds}) == len(kinds)
    assert Method.parse("certified+rest").title == "Certified + rest"
    assert title_of("paper+lightbuffer") == "Paper + light buffer" and title_of("none") == "None (trace all)"
    assert Kind("mine", "Mine.", dict).title == "mine"
