"""Names of methods: put together, taken apart, and ordered."""

from __future__ import annotations

from tracer.experiment import with_reference
from tracer.method import BASES, EXTRAS, is_method
from viewer.state.methods import BASES_TOLD, DEFAULT, EXTRAS_TOLD, in_order, named, toggled, with_base


def test_every_base_and_extra_is_told_of():
    assert tuple(BASES_TOLD) == BASES and tuple(EXTRAS_TOLD) == EXTRAS
    assert is_method(DEFAULT) and DEFAULT != "none"


def test_names_are_those_of_methods_whatever_the_order_of_their_extras():
    assert named("cells", ["rest", "cache"]) == named("cells", {"cache", "rest"}) == "cells+cache+rest"
    assert named("none", []) == "none"
    assert all(is_method(named(base, EXTRAS)) for base in BASES)


def test_a_base_is_exchanged_and_an_extra_put_on_and_taken_off():
    assert with_base("paper+rest", "certified") == "certified+rest"
    assert toggled("certified+rest", "cache") == "certified+cache+rest"
    assert toggled("certified+cache+rest", "rest") == "certified+cache"


def test_methods_are_ordered_by_base_then_by_what_they_take_along():
    methods = {"certified+cache", "certified", "paper+rest", "none", "cells", "paper", "certified+cache+rest"}
    ordered = ["none", "paper", "paper+rest", "cells", "certified", "certified+cache", "certified+cache+rest"]
    assert in_order(methods) == ordered == with_reference(in_order(methods))
