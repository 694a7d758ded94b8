"""What the colours of a view stand for, and how much of a frame has each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.method import Method
from viewer.state.readings import (
    CUT_BOUND,
    arrivals,
    cell_lights,
    cut_nodes,
    lights_due,
    lights_top,
    moving_shadows,
    samples_of,
    untrusted,
    voxels_of,
    whole_of,
    work_of,
    work_top,
)
from viewer.state.slices import Slice
from viewer.state.views import (
    CERTIFICATE_COLORS,
    CERTIFICATE_MEANING,
    OCCLUSION_COLORS,
    OCCLUSION_MEANING,
    SHADOW_COLORS,
    SHADOW_MEANING,
    TRUSTED_MEANING,
    UNTRUSTED_MEANING,
    Arrival,
    Certificate,
    Color,
    MovingShadow,
    View,
)


@dataclass(frozen=True)
class LegendRow:
    """One colour of a legend: what it means, and how much of the frame it is (counts, and fractions of all).

    Units are what carries modes, primitives or cells, or the cells that are seen.  It may have `stripes` of another
    colour."""

    name: str
    color: Color
    meaning: str
    units: int
    pixels: int
    unit_share: float
    pixel_share: float
    stripes: Color | None = None


def occlusion_legend(frame: Frame) -> list[LegendRow]:
    """Units and primary pixels in each occlusion mode."""
    classes = modes.occlusion_mode(frame.modes)
    meaning = OCCLUSION_MEANING | {OcclusionMode.DYNAMIC: _dynamic(frame)}
    rows = [(mode.name, OCCLUSION_COLORS[mode], meaning[mode]) for mode in OcclusionMode]
    return _rows(frame, classes, rows)


def _dynamic(frame: Frame) -> str:
    """What DYNAMIC means to the method: some take what rests for static, and so do modes beside a method."""
    method = Method.parse(frame.settings.method)
    if method.uses_modes and not method.has("rest"):
        return "of an object that can move, also while it rests: never culled"
    return "it moves now: not culled; what can move but rests counts as static"


def shadow_legend(frame: Frame, light: int) -> list[LegendRow]:
    """Units and primary pixels in each shadow mode of a light.  Those that move are counted apart, and so are those
    whose mode is not trusted, as they are not fully rendered.

    Empty for a light that culling does not cover."""
    if not modes.has_shadow_mode(frame.modes, light):
        return []
    classes = modes.shadow_mode(frame.modes, light)
    classes[modes.occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC] = len(ShadowMode)
    striped = untrusted(frame, light)
    classes[striped] += len(ShadowMode)
    rows = [(mode.name, SHADOW_COLORS[mode], (SHADOW_MEANING | TRUSTED_MEANING)[mode]) for mode in ShadowMode]
    rows.append(("DYNAMIC", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], _dynamic(frame)))
    rows += [(f"{mode.name}, untrusted", SHADOW_COLORS[mode], UNTRUSTED_MEANING[mode]) for mode in UNTRUSTED_MEANING]
    found = _rows(frame, classes, rows)
    stripes = SHADOW_COLORS[ShadowMode.INIT]
    init, full, non, partial, dynamic, *doubted = found
    full_too, non_too = (replace(row, stripes=stripes) for row in doubted)
    return [init, full, full_too, non, non_too, partial, dynamic]


def certificate_legend(frame: Frame, light: int) -> list[LegendRow]:
    """Cells that are seen, and primary pixels, with each certificate of a light; what moves is counted apart.

    Empty for a light that culling does not cover, and for a frame without certificates."""
    if frame.certificates is None or not modes.has_shadow_mode(frame.certificates, light):
        return []
    classes = certificates_of(frame, light)
    rows = [(one.name, CERTIFICATE_COLORS[one], CERTIFICATE_MEANING[one]) for one in Certificate]
    rows.append(("DYNAMIC", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], "it moves: never certified"))
    hit = frame.primitive >= 0
    pixels = np.bincount(classes[hit], minlength=len(rows))
    cells = np.zeros(len(rows), np.int64)
    if frame.cells is not None:
        there = hit & (frame.cells >= 0)
        class_of = np.full(int(frame.cells.max(initial=-1)) + 1, len(rows), np.uint8)
        class_of[frame.cells[there]] = classes[there]
        cells = np.bincount(class_of, minlength=len(rows))[: len(rows)]
    return _with_shares(rows, cells, pixels)


def certificates_of(frame: Frame, light: int) -> NDArray[np.uint8]:
    """(h, w) Certificate of a light at each pixel, and one more than there are where a dynamic object is seen."""
    if frame.certificates is not None and modes.has_shadow_mode(frame.certificates, light):
        classes = modes.shadow_mode(frame.certificates, light)
    else:
        classes = np.zeros(frame.primitive.shape, np.uint8)
    if len(frame.modes):
        dynamic = modes.occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC
        classes[dynamic[np.maximum(frame.unit, 0)] & (frame.primitive >= 0)] = len(Certificate)
    return classes


def _rows(frame: Frame, classes: NDArray[np.uint8], rows: list[tuple[str, Color, str]]) -> list[LegendRow]:
    units = np.bincount(classes, minlength=len(rows))
    pixels = np.bincount(classes, weights=frame.pixel_count, minlength=len(rows)).astype(np.int64)
    return _with_shares(rows, units, pixels)


def _with_shares(
    rows: list[tuple[str, Color, str]], units: NDArray[np.int64], pixels: NDArray[np.int64]
) -> list[LegendRow]:
    total, seen = max(int(units.sum()), 1), max(int(pixels.sum()), 1)
    return [
        LegendRow(name, color, meaning, int(u), int(p), int(u) / total, int(p) / seen)
        for (name, color, meaning), u, p in zip(rows, units, pixels)
    ]


@dataclass(frozen=True)
class WorkLegend:
    """What a heat map shows, summed over the pixels that are shaded, and at the most expensive of them; `top` has the
    last colour.

    `whole` is what the total is a part of (`views.whole_of`)."""

    total: int
    whole: int
    per_pixel: float
    most: int
    top: float


def work_legend(frame: Frame, view: View) -> WorkLegend:
    """Of a frame that recorded the work at its pixels; raises ValueError for another."""
    top, work = work_top(frame, view), work_of(frame, view)
    assert work is not None
    whole, known = whole_of(frame, view), frame.shaded
    if known is not None:  # the others show what the nearest of these has
        work, whole = work[known], whole[known]
    total = int(work.sum(dtype=np.int64))
    return WorkLegend(total, int(whole.sum(dtype=np.int64)), total / max(work.size, 1), int(work.max(initial=0)), top)


@dataclass(frozen=True)
class PenumbraLegend:
    """Primary pixels by how much of a light reaches them, of so many that are `seen`, and the most samples of it that a
    pixel faces.  `share` of the samples that pixels in the penumbra face reach them; None without a penumbra."""

    pixels: dict[Arrival, int]
    seen: int
    samples: int
    share: float | None


def penumbra_legend(frame: Frame, light: int) -> PenumbraLegend:
    """Of a frame that recorded what reaches its pixels; raises ValueError for another."""
    hit, found = frame.primitive >= 0, arrivals(frame, light)
    pixels = np.bincount(found[hit], minlength=len(Arrival))
    asked, reached = samples_of(frame, light)
    between = (found == Arrival.FEW) | (found == Arrival.MOST)
    faced = int(asked[between].sum())
    share = int(reached[between].sum()) / faced if faced else None
    counts = {one: int(pixels[one]) for one in Arrival}
    return PenumbraLegend(counts, int(hit.sum()), int(asked.max(initial=0)), share)


@dataclass(frozen=True)
class FateLegend:
    """Primary pixels by the fate of their shadow rays to a light, of so many that are `seen`: so many rays are due,
    and of these so many are saved and traced."""

    pixels: dict[Fate, int]
    seen: int

    @property
    def due(self) -> int:
        return self._sum(lambda fate: fate.is_due)

    @property
    def saved(self) -> int:
        return self._sum(lambda fate: fate.is_saved)

    @property
    def traced(self) -> int:
        return self._sum(lambda fate: fate.is_traced)

    def _sum(self, of: Callable[[Fate], bool]) -> int:
        return sum(pixels for fate, pixels in self.pixels.items() if of(fate))


def fate_legend(frame: Frame, light: int) -> FateLegend:
    """Of a frame that recorded fates; raises ValueError for another."""
    hit = frame.primitive >= 0
    pixels = np.bincount(frame.fate(light)[hit], minlength=len(Fate))
    return FateLegend({fate: int(pixels[fate]) for fate in Fate}, int(hit.sum()))


def moving_shadow_legend(frame: Frame, light: int) -> dict[MovingShadow, int]:
    """Primary pixels by what moving objects have to do with them; raises ValueError for a frame without fates."""
    pixels = np.bincount(moving_shadows(frame, light)[frame.primitive >= 0], minlength=len(MovingShadow))
    return {one: int(pixels[one]) for one in MovingShadow}


@dataclass(frozen=True)
class LightsLegend:
    """How many lights primary pixels face, on average and at most."""

    per_pixel: float
    most: int


def lights_legend(frame: Frame) -> LightsLegend:
    """Of a frame that recorded all lights, of the pixels that are known; raises ValueError for another."""
    due = lights_due(frame)
    seen = due[(frame.primitive >= 0) & (due >= 0)]
    return LightsLegend(float(seen.mean()) if len(seen) else 0.0, lights_top(due))


@dataclass(frozen=True)
class CutsLegend:
    """How many clusters of so many `lights`, each sample of a lamp one, primary pixels are shaded by, on average and at
    most; the median of the part of its light that a pixel can be wrong by; and whether of some this is not known."""

    lights: int
    per_pixel: float
    most: int
    bound: float
    unknown: bool


def cuts_legend(frame: Frame) -> CutsLegend:
    """Of a frame that was shaded by cuts of lights; raises ValueError for another."""
    nodes, hit = cut_nodes(frame), frame.primitive >= 0
    seen = hit & (nodes >= 0)
    bound = float(np.median(frame.layers[CUT_BOUND][seen])) if seen.any() else 0.0
    lights = 0 if frame.statistics.cuts is None else frame.statistics.cuts.lights
    per_pixel = float(nodes[seen].mean()) if seen.any() else 0.0
    return CutsLegend(lights, per_pixel, lights_top(nodes), bound, bool((hit & ~seen).any()))


@dataclass(frozen=True)
class VoxelsLegend:
    """How many voxels of a slice, and in all, are unknown, full and lit, in this order."""

    in_slice: tuple[int, int, int]
    in_all: tuple[int, int, int]


def voxels_legend(frame: Frame, light: int, cut: Slice) -> VoxelsLegend:
    """Of a frame by a method that has voxels; raises ValueError for another."""
    states = voxels_of(frame)
    numbers = np.arange(states.grid.voxels).reshape(states.shape)
    layer = np.take(numbers, cut.layer(states.shape), axis=cut.axis)
    found = np.bincount(states.states(light, layer).reshape(-1), minlength=3)
    return VoxelsLegend((int(found[0]), int(found[1]), int(found[2])), states.counts(light))


@dataclass(frozen=True)
class CellLightsLegend:
    """How many lights the cells of primary pixels must look at, on average and at most; how many cells are in view; and
    whether of some pixels this is not known yet."""

    per_pixel: float
    most: int
    cells: int
    unknown: bool


def cell_lights_legend(frame: Frame) -> CellLightsLegend:
    """Of a frame whose cells know which lights they must look at; raises ValueError for another."""
    asked, hit = cell_lights(frame), frame.primitive >= 0
    seen = hit & (asked >= 0)
    cells = len(np.unique(frame.cell[seen])) if seen.any() else 0
    return CellLightsLegend(
        float(asked[seen].mean()) if seen.any() else 0.0, lights_top(asked), cells, bool((hit & ~seen).any())
    )
