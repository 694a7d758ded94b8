"""Methods as they are offered: what each culls by, what it may take along, and in which order they are named."""

from __future__ import annotations

from collections.abc import Iterable

from tracer.method import BASES, EXTRAS, base_of, takes
from viewer.state.views import View

DEFAULT = "auto"
"""What the window and `render` trace with until another method is chosen."""

BASES_TOLD = {
    "none": "no culling: every shadow ray is traced",
    "paper": "the paper's method: by what shadow rays of each primitive met in earlier frames",
    "cells": "the paper's method on virtual cells of large triangles",
    "certified": "by what is proven of virtual cells: never a wrong answer",
    "auto": "as none or as certified, whichever is quicker here: never a wrong answer",
}

EXTRAS_TOLD = {
    "cache": ("Occluder cache", "test first what blocked the light there last time"),
    "rest": ("Idle objects are static", "objects that could move, but do not move now, count as static until they do"),
}


def default_for(view: View) -> str:
    """The method for one picture in a view: the default one, or one that has something to show there."""
    if view is View.CERTIFICATE or view.needs_work:
        return "certified"
    return "paper" if view.needs_verify else DEFAULT


def named(base: str, extras: Iterable[str]) -> str:
    """The name of a method that takes these extras along."""
    chosen = set(extras)
    return "+".join([base, *(extra for extra in EXTRAS if extra in chosen)])


def extras_of(method: str) -> set[str]:
    """What a method takes along."""
    return {extra for extra in EXTRAS if takes(method, extra)}


def with_base(method: str, base: str) -> str:
    """What culls exchanged; what the method takes along stays."""
    return named(base, extras_of(method))


def toggled(method: str, extra: str) -> str:
    """The method with an extra where it had none, or without."""
    return named(base_of(method), extras_of(method) ^ {extra})


def in_order(methods: Iterable[str]) -> list[str]:
    """Each once, as bases are ordered, and those that take more along later."""
    return sorted(set(methods), key=lambda name: (BASES.index(base_of(name)), [takes(name, extra) for extra in EXTRAS]))
