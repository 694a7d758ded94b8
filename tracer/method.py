"""What methods are called and what they can do: a table with one line for each.

A method says which shadow rays need not be traced.  Its name is that of a base, followed by additions, each joined by
a "+": "certified+cache".  The code of a method is one file in `tracer.methods`; nothing else names it.  Everything
that depends on what a method can do asks the capabilities given here, so that settings can be read, and menus and
help texts made, before any kernel is loaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

ANY_NUMBER = 1 << 31
MANY = 16  # lights: clusters of fewer are hardly ever worth it
#: Methods that are made of others and are worth a look (`line_up`), as far as these are known.
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
    """A base or an addition: its name, one sentence for menus and help texts, the class that implements it, and its
    capabilities.

    `implementation` is a subclass of `tracer.methods.interface.ShadowMethod`, or where one is: "module:Class".
    `culls`: it answers shadow rays without tracing them.  `exact`: its pictures are those of "none", bit for bit.
    `uses_modes`: it culls by the modes of the paper, and keeps
    them in any case.  `uses_cells`: its modes belong to cells of large primitives.  `has_certificates`: it makes
    certificates, or may make some.  `adaptive`: it chooses by itself whether to cull.  `measures`: it serves
    measurements only and is not offered in the window.  `addition`: it can be added to a base; `alone`: and be the base
    itself, with nothing below it.  `lights`: of scenes with so many it has something to say, from least to most; it
    is right for others, too.  `clusters`: it shades by clusters of lights.
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
    clusters: bool = False

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
    names = ", ".join(kind.name for kind in bases(measures=True))
    return f"one of {names}, which may be followed by {' and '.join(f'+{kind.name}' for kind in additions())}"


def line_up(lights: int) -> list[str]:
    """The methods that are worth comparing in a scene of so many lights: all bases, and what goes well together."""
    names = [kind.name for kind in bases(measures=True)] + [name for name in TOGETHER if _is_known(name)]
    return [name for name in names if Method.parse(name).fits(lights)]


def _is_known(name: str) -> bool:
    return all(part in _KINDS for part in name.split("+"))


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
            raise ValueError(f"method is {choice()}, not {name!r}")
        return Method(_KINDS[base], tuple(_KINDS[extra] for extra in extras))

    def __str__(self) -> str:
        return "+".join(kind.name for kind in self.kinds)

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

    def fits(self, lights: int) -> bool:
        """Whether it has anything to say of a scene with so many lights."""
        return all(kind.lights[0] <= lights <= kind.lights[1] for kind in self.kinds)

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
    def learns(self) -> bool:
        """Whether what it counts in a frame may depend on the frames before it: it knows something of them."""
        return self.culls or bool(self.added)

    @property
    def adaptive(self) -> bool:
        """Whether it chooses by itself whether to cull."""
        return any(kind.adaptive for kind in self.kinds)


register(
    Kind(
        "none",
        "Traces every shadow ray: the truth that others are compared with.",
        "tracer.methods.none:NoCulling",
        culls=False,
    )
)
register(
    Kind(
        "paper",
        "Culls by the paper's shadow modes of whole primitives; wrong now and then.",
        "tracer.methods.paper:Paper",
        exact=False,
        uses_modes=True,
    )
)
register(
    Kind(
        "cells",
        "The paper's modes, kept for the cells of large triangles; wrong now and then.",
        "tracer.methods.cells:Cells",
        exact=False,
        uses_modes=True,
        uses_cells=True,
    )
)
register(
    Kind(
        "certified",
        "Culls by what is proven of the cells of triangles; never wrong.",
        "tracer.methods.certified:certified",
        has_certificates=True,
    )
)
register(
    Kind(
        "auto",
        "Culls by certificates where that is measured to be quicker; never wrong.",
        "tracer.methods.auto:Auto",
        has_certificates=True,
        adaptive=True,
    )
)
register(
    Kind(
        "free",
        "Replays the answers of the same frame: no culling can be faster.",
        "tracer.methods.free:Free",
        measures=True,
    )
)
register(
    Kind(
        "lightcuts",
        "Shades by clusters of lights, as fine as a bound of the error asks for.",
        "tracer.methods.lightcuts:Lightcuts",
        exact=False,
        lights=(MANY, ANY_NUMBER),
        clusters=True,
    )
)
register(
    Kind(
        "lightcuts-stochastic",
        "Lightcuts with lights drawn for each pixel: noise, which averages out, instead of bands.",
        "tracer.methods.lightcuts_stochastic:StochasticLightcuts",
        exact=False,
        lights=(MANY, ANY_NUMBER),
        clusters=True,
    )
)
register(
    Kind(
        "lightcuts-certified",
        "Lightcuts of those lights that are not proven to be hidden.",
        "tracer.methods.lightcuts_certified:CertifiedLightcuts",
        exact=False,
        lights=(MANY, ANY_NUMBER),
        clusters=True,
        has_certificates=True,
    )
)
register(
    Kind(
        "voxels",
        "Culls by cubes of space that are lit, or in shadow, as a whole; never wrong.",
        "tracer.methods.voxels:Voxels",
        has_certificates=True,
        lights=(0, 31),
        addition=True,
        alone=True,
    )
)
register(
    Kind(
        "lie-exact",
        "Asks what is proven to block a light from a cell of space, and no light hidden from it; never wrong.",
        "tracer.methods.lie:Environments",
        has_certificates=True,
        addition=True,
        alone=True,
    )
)
register(
    Kind(
        "lie",
        "Local illumination environments, by samples as published; wrong now and then.",
        "tracer.methods.lie:SampledEnvironments",
        exact=False,
        has_certificates=True,
        addition=True,
        alone=True,
    )
)
register(Kind("cache", "Tests what blocked a light before first.", "tracer.methods.cache:OccluderCache", addition=True))
register(Kind("rest", "Counts objects that rest as static.", "tracer.methods.rest:Resting", culls=False, addition=True))
register(
    Kind(
        "lightbuffer",
        "Looks up what each light sees in each direction; never wrong.",
        "tracer.methods.lightbuffer:LightBuffer",
        lights=(0, 31),
        addition=True,
        alone=True,
    )
)
register(
    Kind(
        "cache-directions",
        "Tests first what blocked a light before in this direction.",
        "tracer.methods.cache:DirectionCache",
        addition=True,
        measures=True,
    )
)
register(
    Kind(
        "cache-tile",
        "Tests first what blocked a light before in this tile of the picture.",
        "tracer.methods.cache:TileCache",
        addition=True,
        measures=True,
    )
)
register(
    Kind(
        "packets16",
        "Traces rays in packets of 16 instead of 128.",
        "tracer.methods.packets:Packets16",
        culls=False,
        addition=True,
        measures=True,
    )
)
register(
    Kind(
        "packets1",
        "Traces rays one by one instead of in packets.",
        "tracer.methods.packets:Packets1",
        culls=False,
        addition=True,
        measures=True,
    )
)
