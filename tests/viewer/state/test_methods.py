"""Names of methods: put together, taken apart, and ordered."""

from __future__ import annotations

from tracer.experiments.experiment import with_reference
from tracer.method import DEFAULT_METHOD, Method, additions, bases, in_order
from tracer.settings import Settings
from viewer.state import codec
from viewer.state.methods import (
    ADAPTIVE,
    BY_MODES,
    CERTIFIED,
    NO_CULLING,
    SHOWN_BY,
    default_for,
    groups,
    is_method,
    toggled,
    with_base,
)
from viewer.state.session import Session
from viewer.state.views import View


def test_methods_that_are_chosen_by_name_can_do_what_they_are_chosen_for():
    assert not Method.parse(NO_CULLING).culls and Method.parse(BY_MODES).uses_modes
    certified = Method.parse(CERTIFIED)
    assert certified.has_certificates and not certified.adaptive
    assert Method.parse(ADAPTIVE).adaptive and Method.parse(ADAPTIVE).exact


def test_one_method_is_the_default_everywhere_that_has_something_to_show():
    assert DEFAULT_METHOD == Settings().method == Session().settings.method == codec.recalled({}).settings.method
    assert Method.parse(DEFAULT_METHOD).uses_modes and Method.parse(DEFAULT_METHOD).culls
    assert {view: default_for(view) for view in View if default_for(view) != DEFAULT_METHOD} == SHOWN_BY


def test_every_method_that_can_be_put_together_exists():
    for base in bases():
        name = base.name
        for addition in additions():
            name = toggled(name, addition.name)
            assert is_method(name) and Method.parse(name).base == base.name
    assert not is_method("fast") and not is_method("paper+fast")


def test_a_base_is_exchanged_and_an_addition_put_on_and_taken_off():
    assert with_base("paper+rest", "certified") == "certified+rest"
    assert with_base("cells+rest+cache", "paper") == "paper+cache+rest", "additions come in their usual order"
    assert toggled("certified+rest", "cache") == "certified+cache+rest"
    assert toggled("certified+cache+rest", "rest") == "certified+cache"


def test_methods_are_ordered_by_base_then_by_their_additions():
    methods = {"certified+cache", "certified", "paper+rest", "none", "cells", "paper", "certified+cache+rest"}
    ordered = ["none", "paper", "paper+rest", "cells", "certified", "certified+cache", "certified+cache+rest"]
    assert in_order(methods) == ordered == with_reference(in_order(methods))


def test_the_list_of_methods_has_each_once_among_its_like():
    listed = [kind for _, kinds in groups() for kind in kinds]
    assert sorted(kind.name for kind in listed) == sorted(kind.name for kind in bases())
    (_, exact), (_, wrong) = groups()
    assert {kind.exact for kind in exact} == {True} and {kind.exact for kind in wrong} == {False}


def test_each_method_says_what_it_trusts_and_whether_it_is_exact():
    for kind in bases(measures=True):
        assert kind.summary.startswith(("Trusts ", "Lightcuts ")) and kind.summary.endswith("."), kind.name
        assert ("Exact" in kind.summary) == kind.exact, kind.name
        assert ("Wrong now and then." in kind.summary or "Not exact." in kind.summary) != kind.exact, kind.name
