"""What a renderer gives back."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from html import escape
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.fate import FATE, MOVING_SHADOW, Fate, by_modes
from tracer.method import Method
from tracer.scene.model import Camera
from tracer.settings import Settings
from tracer.statistics import FrameStatistics

Region = tuple[slice, slice]
EVERYWHERE: Region = (slice(None), slice(None))


@dataclass(eq=False)  # arrays cannot be compared as one
class Frame:
    """One picture, and what was found out about it.

    All arrays are C-contiguous, with row 0 at the top. h and w are the height and width of the picture. A unit is what
    carries modes: a primitive, or a cell of one.

    Attributes
    ----------
    time : float
        The moment that the picture shows, in seconds.
    camera : Camera
        The camera that it was taken with.
    settings : Settings
        How it was rendered.
    color : (h, w, 3) float32
        Linear colour, not clamped.
    depth : (h, w) float32
        Distance along the unit ray, inf for a miss.
    primitive : (h, w) int32
        Number of the primitive, -1 for a miss.
    normal : (h, w, 3) float32
        Shading normal, on the viewer's side.
    modes : (units,) uint32 or uint64
        The packed words of modes as this frame leaves them, or would if no more of it were shaded; without meaning
        unless `settings.keeps_modes`.
    modes_before : (units,) uint32 or uint64
        The same as the last frame left them: what shadow testing has gone by.
    pixel_count, highest_count : (units,) int32
        Pixels that a unit covers now, and those that it covered when it was last examined; 0 where it never was.
    lights : int
        How many lights there are.
    asked, reached : (h, w, lights) uint16
        How many samples of a light the primary hit faces, and how many of their shadow rays reach it; with
        `record_lights`. A point has one sample.
    fates : (h, w, lights) uint8
        What became of the shadow rays from the primary hit to a light, as it is recorded (`fate`, `moving_shadow`), 0
        where that is not known; with `record_fates`, for methods that do not cluster lights.
    only_light : int
        The light that they are of, which alone has a column, or None for all (`tracer.inspect.one_light`).
    shaded : (h, w) bool
        The pixels that have been shaded, of which `asked` and `reached` are known; None if these are all.
    reference : (h, w, 3) float32
        The picture with every shadow answer right, that of "none" bit for bit; with `verify`.
    wrong : (h, w) int32
        Wrong answers that count for a pixel, at all bounces and of all samples; with `verify`.
    cells : (h, w) int32
        The virtual cell at each pixel, -1 for none; for methods that have cells.
    certificates : (h, w) uint32 or uint64
        Words like `modes`, with certificates in the place of shadow modes, 0 for none; for methods that make
        certificates.
    saved : (h, w) int32
        Shadow rays of a pixel that were not traced through the whole scene, those that asked candidates or met a cached
        occluder among them: what is *untraced*, of which `ShadowCounts.saved` is a part. The name is older than these
        words, and stays. With `record_work`.
    cost : (h, w) int32
        Rays of all kinds that were traced for a pixel; with `record_work`. Without culling there are `saved + cost`.
    due_rays : (h, w) int32
        Shadow rays of a pixel that were due; with `record_work`.
    layers : dict of str to array
        Whatever else the method shows at each pixel, by name.
    structures : dict of str to object
        What else the method shows, by name, as this frame found it: "voxels"
        (`tracer.neighbours.voxels.tell.VoxelStates`) and "light cubes", of each of the first lights
        (`tracer.neighbours.lightbuffer.tell.LightCube`).
    statistics : FrameStatistics
        What the frame cost.
    """

    time: float
    camera: Camera
    settings: Settings
    color: NDArray[np.float32]
    depth: NDArray[np.float32]
    primitive: NDArray[np.int32]
    normal: NDArray[np.float32]
    modes: NDArray[np.unsignedinteger]
    modes_before: NDArray[np.unsignedinteger]
    pixel_count: NDArray[np.int32]
    highest_count: NDArray[np.int32]
    lights: int
    asked: NDArray[np.uint16] | None = None
    reached: NDArray[np.uint16] | None = None
    fates: NDArray[np.uint8] | None = None
    only_light: int | None = None
    shaded: NDArray[np.bool_] | None = None
    reference: NDArray[np.float32] | None = None
    wrong: NDArray[np.int32] | None = None
    cells: NDArray[np.int32] | None = None
    certificates: NDArray[np.unsignedinteger] | None = None
    saved: NDArray[np.int32] | None = None
    cost: NDArray[np.int32] | None = None
    due_rays: NDArray[np.int32] | None = None
    layers: dict[str, NDArray] = field(default_factory=dict)
    structures: dict[str, Any] = field(default_factory=dict)
    statistics: FrameStatistics = field(default_factory=FrameStatistics)

    @property
    def width(self) -> int:
        return self.primitive.shape[1]

    @property
    def height(self) -> int:
        return self.primitive.shape[0]

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8, row 0 at the top: the picture as a screen shows it."""
        return pixels_of(self.color)

    def _repr_png_(self) -> bytes:
        return _png_of(self.color)

    def _repr_html_(self) -> str:
        title = f"{self.time:.3f} s, {self.width} × {self.height}, method {self.settings.method}"
        return _html_of(self.color, title, self.statistics)

    @property
    def due(self) -> NDArray[np.bool_] | None:
        """(h, w, lights) bool: whether any shadow ray of the primary hit to the light is due; with `record_lights`."""
        return None if self.asked is None else self.asked > 0

    @property
    def lit(self) -> NDArray[np.bool_] | None:
        """(h, w, lights) bool: whether any of them reaches the light; with `record_lights`."""
        return None if self.reached is None else self.reached > 0

    @property
    def cell(self) -> NDArray[np.int32]:
        """(h, w) int32: the unit that carries modes at each pixel, a virtual cell or the primitive itself."""
        return self.primitive if self.cells is None else self.cells

    @property
    def unit(self) -> NDArray[np.int32]:
        """(h, w) int32: the same, but never one of those cells that have certificates and no modes."""
        return self.cell if self.certificates is None else self.primitive

    @property
    def occlusion_mode(self) -> NDArray[np.uint8]:
        """(h, w) uint8: the OcclusionMode of each pixel's unit, 255 for a miss."""
        return self._per_pixel(modes.occlusion_mode(self.modes))

    @property
    def shadow_mode(self) -> NDArray[np.uint8]:
        """(h, w, lights) uint8: the ShadowMode of each pixel's unit, 255 for a miss."""
        planes = [self._per_pixel(modes.shadow_mode(self.modes, light)) for light in range(self.lights)]
        return np.stack(planes, axis=-1) if planes else np.empty((*self.primitive.shape, 0), np.uint8)

    def fate(self, light: int, where: Region = EVERYWHERE) -> NDArray[np.uint8]:
        """What became of the shadow ray of each pixel's primary hit to a light.

        Of a lamp with several samples, it is the fate of the ray that asked most. Pixels that have not been shaded yet
        have that of the nearest that has, and go by their own modes.

        Parameters
        ----------
        light : int
            Number of the light.
        where : (slice, slice), optional
            The rows and columns of the picture that are asked about; all, if none are given.

        Returns
        -------
        (h, w) uint8
            The Fate of each pixel, NONE for a miss.

        Raises
        ------
        ValueError
            If the frame has no record of fates.
        """
        hit = self.primitive[where] >= 0
        fates = np.where(hit, self._recorded_fates(light, where) & np.uint8(FATE), np.uint8(Fate.NONE))
        method = Method.parse(self.settings.method)
        if method.uses_modes:
            recorded, said = fates[hit], by_modes(fates[hit], self.modes_before[self.unit[where][hit]], light)
            if any(kind.culls for kind in method.added):  # one of these may have answered what modes have not
                said = np.where((recorded < Fate.TRACED) & (said >= Fate.PARTLY_OCCLUDED), recorded, said)
            fates[hit] = said
        return fates

    def moving_shadow(self, light: int, where: Region = EVERYWHERE) -> NDArray[np.bool_]:
        """(h, w): where nothing static, but something dynamic is between the primary hit and a light, or some sample
        of it; as `fate`."""
        moving = self._recorded_fates(light, where) & np.uint8(MOVING_SHADOW) != 0
        return moving & (self.primitive[where] >= 0)

    def _recorded_fates(self, light: int, where: Region) -> NDArray[np.uint8]:
        if self.fates is None:
            raise ValueError("the frame did not record what became of its shadow rays")
        return self.fates[(*where, light)]

    def _per_pixel(self, values: NDArray[np.uint8]) -> NDArray[np.uint8]:
        units = self.unit
        hit = units >= 0
        result = np.full(units.shape, 255, np.uint8)
        result[hit] = values[units[hit]]
        return result


# --- as notebooks show it -----------------------------------------------------------------------------


def pixels_of(color: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(h, w, 3) uint8: linear colours (h, w, 3) as a screen shows them."""
    return np.round(np.clip(color, 0.0, 1.0) * np.float32(255.0)).astype(np.uint8)


def _png_of(color: NDArray[np.float32]) -> bytes:
    """The file of the picture of these colours, (h, w, 3)."""
    from PIL import Image

    file = BytesIO()
    Image.fromarray(pixels_of(color)).save(file, "PNG")
    return file.getvalue()


def counters(statistics: FrameStatistics) -> list[tuple[str, str]]:
    """Names and values of a frame's counters, as people read them."""
    rays, wrong = statistics.shadow, statistics.wrong
    due = max(rays.due, 1)
    lines = [
        ("shadow rays due", f"{rays.due:,}"),
        ("saved", f"{rays.saved:,} ({rays.saved / due:.1%})"),
        ("culled", f"{rays.culled:,} ({rays.culled / due:.1%})"),
        ("dynamic only", f"{rays.dynamic_only:,} ({rays.dynamic_only / due:.1%})"),
        ("traced", f"{rays.traced:,} ({rays.traced / due:.1%})"),
        ("traversal steps", f"{rays.traversal_steps + statistics.certificate_steps:,}"),
        ("intersection tests", f"{rays.intersection_tests + statistics.certificate_tests:,}"),
        ("frame", f"{1000.0 * statistics.seconds:.1f} ms"),
    ]
    if wrong is not None:
        lines.insert(5, ("wrong answers", f"{wrong.answers:,}"))
    return lines


def _html_of(color: NDArray[np.float32], title: str, statistics: FrameStatistics) -> str:
    """The picture, (h, w, 3), beside its counters."""
    height, width = color.shape[:2]
    image = base64.b64encode(_png_of(color)).decode()
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td style='text-align:right'>{value}</td></tr>"
        for name, value in counters(statistics)
    )
    return (
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>"
        f"<img width='{width}' height='{height}' alt='{escape(title)}' src='data:image/png;base64,{image}'>"
        f"<table><caption style='text-align:left'>{escape(title)}</caption>{rows}</table></div>"
    )
