"""What methods are called and what they can do: a table with one line for each.

A method says which shadow rays need not be traced.  Its name is that of a base, followed by additions, each joined by
a "+": "certified+cache".  The code of a method is one file in `tracer.methods`; nothing else names it.  Everything
that depends on what a method can do asks the capabilities given here, so that settings can be read, and menus and
help texts made, before any kernel is loaded.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

from tracer.util.suggest import similar

DEFAULT_METHOD = "paper"
"""What culls until another method is chosen, in scripts, commands and the window alike."""
ANY_NUMBER = 1 << 31
MANY = 16  # lights: clusters of fewer are hardly ever worth it
HELD = 31  # lights that words of modes have room for (`tracer.culling.modes.MAX_CULLED_LIGHTS`)
#: Methods that are made of others and are worth a look (`line_up`).
TOGETHER = (
    "paper+cache",
    "certified+cache",
    "paper+lightbuffer",
    "certified+lightbuffer",
    "paper+voxels",
    "certified+voxels",
    "certified+lie-exact",
)


@dataclass(frozen=True)
class Kind:
    """A base or an addition: its name in files and commands, what it trusts and whether it is exact, for menus and help
    texts, the class that implements it, and its capabilities.

    `title` is what people read; the name where none is given.
    `implementation` is a subclass of `tracer.methods.interface.ShadowMethod`, or where one is: "module:Class".
    `culls`: it answers shadow rays without tracing them. `exact`: its pictures are those of "none", bit for bit.
    `uses_modes`: it culls by the modes of the paper, and keeps them in any case. `uses_cells`: its modes belong to
    cells of large primitives. `has_certificates`: it makes certificates, or may make some. `adaptive`: it chooses by
    itself whether to cull. `measures`: it serves measurements only and is not offered in the window. `addition`: it
    can be added to a base; `alone`: and be the base itself, with nothing below it. `lights`: of scenes with so many it
    has something to say, from least, of all samples of lamps, to most; it is right for others, too. `answers`: it
    answers rays to so many lights, the first ones, and leaves others to tracing. `lamps`: it answers rays to lamps of
    several samples. `in_part`: of lights past `answers`, and of lamps, it knows in part which are hidden. `clusters`:
    it shades by clusters of lights. `makes`: what it makes before shading, and how, as in "voxels classified";
    `FrameStatistics.certificates` is their number.
    """

    name: str
    summary: str
    implementation: Any
    culls: bool = True
    exact: bool = True
    uses_modes: bool = False
    uses_cells: bool = False
    has_certificates: bool = False
    adaptive: bool = False
    measures: bool = False
    addition: bool = False
    alone: bool = False
    lights: tuple[int, int] = (0, ANY_NUMBER)
    answers: int = ANY_NUMBER
    lamps: bool = True
    in_part: bool = False
    clusters: bool = False
    makes: str = ""
    title: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "title", self.title or self.name)

    @property
    def plus(self) -> str:
        """How it reads where it is added to a base: "+ occluder cache"."""
        return f"+ {self.title[:1].lower()}{self.title[1:]}"

    def fits(self, lights: int, samples: int | None = None) -> bool:
        """Whether it has anything to say of a scene with so many lights and, unless one each, samples of them."""
        return self.lights[0] <= (lights if samples is None else samples) and lights <= self.lights[1]

    def load(self) -> Any:
        """The class that implements it."""
        if not isinstance(self.implementation, str):
            return self.implementation
        module, name = self.implementation.split(":")
        return getattr(import_module(module), name)


_KINDS: dict[str, Kind] = {}


def register(kind: Kind) -> Kind:
    """Make a method, or an addition, known by its name.  Raises ValueError where the name is taken."""
    if kind.name in _KINDS:
        raise ValueError(f"there is a method {kind.name!r} already")
    _KINDS[kind.name] = kind
    Method.parse.cache_clear()
    return kind


def unregister(name: str) -> None:
    """Forget a method that was registered."""
    del _KINDS[name]
    Method.parse.cache_clear()


def bases(measures: bool = False) -> tuple[Kind, ...]:
    """All bases, in the order of menus; with those that only measure, where asked for."""
    return tuple(kind for kind in _KINDS.values() if _can_be_base(kind) and (measures or not kind.measures))


def additions(base: str = "", measures: bool = False) -> tuple[Kind, ...]:
    """All that can be added to a base, all but itself; with those that only measure, where asked for."""
    return tuple(
        kind for kind in _KINDS.values() if kind.addition and kind.name != base and (measures or not kind.measures)
    )


def _can_be_base(kind: Kind | None) -> bool:
    return kind is not None and (kind.alone or not kind.addition)


def choice() -> str:
    """What there is to choose from, in words."""
    names, added = (", ".join(f"{plus}{kind.name}" for kind in kinds) for plus, kinds in _offered())
    return f"one of {names}, each of which may be followed by any of {added}"


def _offered() -> tuple[tuple[str, tuple[Kind, ...]], tuple[str, tuple[Kind, ...]]]:
    """All bases and all additions, those included that only measure, and what stands before their names."""
    return ("", bases(measures=True)), ("+", additions(measures=True))


def meant(name: str) -> str:
    """The method that somebody may have meant by a name that is none; "" where it is like none."""
    base, *extras = name.split("+")
    known = [[kind.name for kind in kinds] for _, kinds in _offered()]
    if base in known[1] and base not in known[0]:  # it can only be added
        base, extras = "none", [base, *extras]
    found = [similar(base, known[0]), *(similar(extra, known[1]) for extra in extras)]
    whole = "+".join(dict.fromkeys(found))
    return whole if all(found) and whole != name and found[0] not in found[1:] else ""


def unknown(names: Sequence[str]) -> str:
    """What is said of names that are no methods: "'papper': did you mean 'paper'?", and what there is to choose from
    only where a name is like none."""
    asked = [f"{name!r}: did you mean '{close}'?" for name in names if (close := meant(name))]
    strange = " and ".join(repr(name) for name in names if not meant(name))
    return " ".join([*asked, f"{strange}; it is {choice()}"] if strange else asked)


def line_up(lights: int, samples: int | None = None) -> list[str]:
    """The methods that are worth comparing in a scene of so many lights and samples of them (`Kind.fits`): all
    bases, and what goes well together."""
    names = [*(kind.name for kind in bases(measures=True)), *TOGETHER]
    return [name for name in names if Method.parse(name).fits(lights, samples)]


@dataclass(frozen=True)
class Method:
    """A base with its additions, in the order in which they were named."""

    kind: Kind
    added: tuple[Kind, ...] = ()

    @staticmethod
    @cache
    def parse(name: str) -> Method:
        """The method of a name.  Raises ValueError, in one line, where there is none."""
        base, *extras = name.split("+")
        kind, added = _KINDS.get(base), tuple(_KINDS.get(extra) for extra in extras)
        repeated = len({base, *extras}) <= len(extras)
        if not _can_be_base(kind) or repeated or not all(extra and extra.addition for extra in added):
            raise ValueError(f"no method {unknown([name])}")
        return Method(_KINDS[base], tuple(_KINDS[extra] for extra in extras))

    def __str__(self) -> str:
        return "+".join(kind.name for kind in self.kinds)

    @property
    def title(self) -> str:
        """What people read: "Certified + occluder cache"."""
        return " ".join((self.kind.title, *(kind.plus for kind in self.added)))

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The base, then its additions."""
        return (self.kind, *self.added)

    @property
    def base(self) -> str:
        """The name of the base."""
        return self.kind.name

    @property
    def additions(self) -> tuple[str, ...]:
        """The names of the additions."""
        return tuple(kind.name for kind in self.added)

    def has(self, addition: str) -> bool:
        """Whether an addition is part of the method."""
        return addition in self.additions

    def fits(self, lights: int, samples: int | None = None) -> bool:
        """Whether it has anything to say of a scene with so many lights and samples of them, as `Kind.fits`."""
        return all(kind.fits(lights, samples) for kind in self.kinds)

    @property
    def exact(self) -> bool:
        """Whether its pictures are those of "none", bit for bit."""
        return all(kind.exact for kind in self.kinds)

    @property
    def culls(self) -> bool:
        """Whether it answers shadow rays without tracing them."""
        return any(kind.culls for kind in self.kinds)

    @property
    def uses_modes(self) -> bool:
        """Whether it culls by the modes of the paper."""
        return any(kind.uses_modes for kind in self.kinds)

    @property
    def uses_cells(self) -> bool:
        """Whether its modes belong to cells of large primitives."""
        return any(kind.uses_cells for kind in self.kinds)

    @property
    def has_certificates(self) -> bool:
        """Whether it makes certificates, or may make some."""
        return any(kind.has_certificates for kind in self.kinds)

    @property
    def clusters(self) -> bool:
        """Whether it shades by clusters of lights, and looks at few lights themselves."""
        return any(kind.clusters for kind in self.kinds)

    @property
    def makes(self) -> tuple[str, ...]:
        """What it makes before shading, in words."""
        return tuple(dict.fromkeys(kind.makes for kind in self.kinds if kind.makes))

    @property
    def learns(self) -> bool:
        """Whether what it counts in a frame may depend on the frames before it: it knows something of them."""
        return self.culls or bool(self.added)

    @property
    def adaptive(self) -> bool:
        """Whether it chooses by itself whether to cull."""
        return any(kind.adaptive for kind in self.kinds)


_BY_MODES = {"exact": False, "uses_modes": True, "answers": HELD}
_CUTS = {"exact": False, "lights": (MANY, ANY_NUMBER), "clusters": True}
_EITHER = {"addition": True, "alone": True}
_OF_SPACE = {**_EITHER, "has_certificates": True, "answers": HELD, "lamps": False}
_IN_PART = {**_OF_SPACE, "in_part": True, "makes": "cells settled"}
_FEW = {"lights": (0, HELD), "answers": HELD, "lamps": False}
_PROVES = {"has_certificates": True, "makes": "certificates made"}
_MEASURE = {"addition": True, "measures": True}

# Name, title, class in `tracer.methods`, what it can do, what it trusts and whether it is exact; in the order of menus.
_TABLE: tuple[tuple[str, str, str, dict[str, Any], str], ...] = (
    ("none", "None (trace all)", "none:NoCulling", {"culls": False},
     "Trusts nothing: traces every shadow ray. Exact; all others are compared with it."),
    ("paper", "Paper", "paper:Paper", _BY_MODES,
     "Trusts what the shadow rays of a primitive have met since all of it was seen (§2.4). Wrong now and then."),
    ("cells", "Cells", "cells:Cells", {**_BY_MODES, "uses_cells": True},
     "Trusts the same as Paper, but of the cells of large triangles. Wrong now and then."),
    ("certified", "Certified", "certified:certified", _PROVES,
     "Trusts only what is proved of the cells of triangles. Exact."),
    ("auto", "Automatic", "auto:Auto", {**_PROVES, "adaptive": True},
     "Trusts certificates where they measurably save time. Exact."),
    ("free", "Free (answers known)", "free:Free", {"measures": True},
     "Trusts the answers of the same frame, traced before: no culling can be faster. Exact."),
    ("lightcuts", "Lightcuts", "lightcuts:Lightcuts", _CUTS,
     "Trusts a bound of the error, by which clusters of lights are as fine as asked for. Not exact."),
    ("lightcuts-stochastic", "Lightcuts, stochastic", "lightcuts_stochastic:StochasticLightcuts", _CUTS,
     "Lightcuts with lights drawn for each pixel: noise, which averages out, instead of bands. Not exact."),
    ("lightcuts-certified", "Lightcuts, certified", "lightcuts_certified:CertifiedLightcuts", {**_CUTS, **_PROVES},
     "Lightcuts of those lights that are not proved to be hidden. Not exact."),
    ("voxels", "Voxels", "voxels:Voxels", {**_OF_SPACE, **_FEW, "makes": "voxels classified"},
     "Trusts cubes of space that are proved to be lit, or in shadow, as a whole. Exact."),
    ("lie-exact", "Local illumination environments, exact", "lie:Environments", _IN_PART,
     "Trusts what is proved to be all that can block a light from a cell of space. Exact."),
    ("lie", "Local illumination environments", "lie:SampledEnvironments", {**_IN_PART, "exact": False},
     "Trusts samples of what blocks a light from a cell of space, as published. Wrong now and then."),
    ("cache", "Occluder cache", "cache:OccluderCache", {"addition": True},
     "Tests what blocked a light before first. As exact as the method."),
    ("rest", "Rest", "rest:Resting", {"addition": True, "culls": False},
     "Counts objects that rest as static. As exact as the method."),
    ("lightbuffer", "Light buffer", "lightbuffer:LightBuffer", {**_EITHER, **_FEW, "makes": "light buffers made"},
     "Trusts lists of all that each light can meet in each direction. Exact."),
    ("cache-directions", "Occluder cache by direction", "cache:DirectionCache", _MEASURE,
     "Tests first what blocked a light before in this direction."),
    ("cache-tile", "Occluder cache by tile", "cache:TileCache", _MEASURE,
     "Tests first what blocked a light before in this tile of the picture."),
    ("packets16", "Packets of 16 rays", "packets:Packets16", {**_MEASURE, "culls": False},
     "Traces rays in packets of 16 instead of 128."),
    ("packets1", "Single rays", "packets:Packets1", {**_MEASURE, "culls": False},
     "Traces rays one by one instead of in packets."),
)  # fmt: skip

for _name, _title, _class, _can, _sentence in _TABLE:
    register(Kind(_name, _sentence, f"tracer.methods.{_class}", title=_title, **_can))


def title_of(method: str) -> str:
    """Return what people read of a method, by its name; of one that is not there, as in kept results, that name."""
    return Method.parse(method).title if all(part in _KINDS for part in method.split("+")) else method


def in_order(methods: Iterable[str]) -> list[str]:
    """Return methods, each once, in the order of bases, and those with more additions later."""
    names, extras = [kind.name for kind in bases(measures=True)], [kind.name for kind in additions(measures=True)]

    def rank(name: str) -> tuple[int, list[bool]]:
        method = Method.parse(name)
        return names.index(method.base), [method.has(extra) for extra in extras]

    return sorted(set(methods), key=rank)
