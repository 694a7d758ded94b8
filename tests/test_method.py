"""Names of methods, and what they can do."""

import pytest

from tracer.method import Kind, Method, additions, bases, choice, register, unregister


def test_a_name_gives_a_base_additions_and_capabilities():
    method = Method.parse("certified+cache+rest")
    assert (method.base, method.additions, str(method)) == ("certified", ("cache", "rest"), "certified+cache+rest")
    assert method.exact and method.has_certificates and method.culls and not method.uses_modes
    assert method.has("cache") and not method.has("certified")
    assert Method.parse("cells").uses_cells and Method.parse("auto").adaptive
    assert not Method.parse("none+rest").culls and Method.parse("none+cache").culls
    assert {kind.name for kind in bases() if not kind.exact} == {"paper", "cells"}


@pytest.mark.parametrize(
    "name", ["", "paperr", "cache", "paper+", "paper+none", "paper+cache+cache", "+cache", "Paper"]
)
def test_other_names_are_refused_in_one_line_that_says_what_there_is(name):
    with pytest.raises(ValueError, match="method is one of none, paper") as error:
        Method.parse(name)
    assert "\n" not in str(error.value) and "+cache and +rest" in str(error.value)


def test_a_kind_is_registered_once_and_can_be_taken_back():
    before = bases(), additions(), choice()
    with pytest.raises(ValueError, match="already"):
        register(Kind("paper", "", object))
    kind = register(Kind("mine", "Mine.", dict))
    assert Method.parse("mine+rest").kind is kind and kind.load() is dict
    unregister("mine")
    assert (bases(), additions(), choice()) == before
    with pytest.raises(ValueError, match="not 'mine'"):
        Method.parse("mine")
