"""The views by their names, and what is declared of each.

A view is one file in `viewer/views`, which has its name: it is found there when it is first asked about, so that what
lies below the views can ask for a label without knowing how anything is drawn."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, StrEnum
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tracer.frame import Frame


MOST_RECORDED = 1 << 28
"""Pixels times lights, at most, of which all samples are recorded: a gigabyte of memory."""

MOST_TOGETHER = 32
"""Lights, at most, that are recorded together for a view of one: of more, the one is looked at alone, which is done
soon and asks for no other frame."""

CUT_NODES, CUT_BOUND = "cut nodes", "cut bound"  # layers of methods that shade by cuts of lights
CELL_LIGHTS = "cell lights"  # that of methods whose cells know which lights they must look at
REGRET = "regret"  # what the renderer is asked for
VOXELS, LIGHT_CUBES = "voxels", "light cubes"  # structures of methods


class Record(Enum):
    """What a frame must have been asked to record for a view, by the setting that asks for it."""

    VERIFY = "verify"
    WORK = "record_work"
    LIGHTS = "record_lights"
    FATES = "record_fates"


class Declaration:
    """What a view says of itself; `label`, `key` and `help` are its own in any case."""

    label: ClassVar[str]
    key: ClassVar[str]
    help: ClassVar[str]
    also: ClassVar[str] = ""
    """Words by which it is found as well."""
    shows: ClassVar[str] = ""
    """The buffer, the layer or the structure of a frame that it shows, if only some frames have it."""
    records: ClassVar[Record | None] = None
    of_light: ClassVar[bool] = False
    """Whether it is about one light."""
    of_modes: ClassVar[bool] = False
    """Whether it shows modes, of frames that keep them alone."""
    has_range: ClassVar[bool] = False
    """Whether it shows a number on the colour map, whose range can be chosen."""
    has_slice: ClassVar[bool] = False
    """Whether it shows a slice through space, which can be chosen."""
    is_flat: ClassVar[bool] = False
    """Whether it shows flat colours, under which the picture's light and shade can be seen."""
    shows_picture: ClassVar[bool] = False
    """Whether it shows traced colours, by the tone that is chosen."""
    shows_clipped: ClassVar[bool] = False
    """Whether it can mark what the screen cuts off of its colours, and may be smoothed where it is enlarged."""

    asks: ClassVar[Callable[..., dict[str, Any]] | None] = None
    """What finds the layers that it shows of a whole frame with certificates of cells, as that takes longer than a
    frame may: of the renderer, the frame, a light, `cancelled()`, and perhaps `report(part)`, to which it says which
    part is found.  It may raise LookupError and Cancelled."""

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        """Return whether the frame holds what it shows, of this light where it is about one."""
        if self.of_modes:
            return frame.settings.keeps_modes
        name = self.shows
        return not name or name in frame.layers or name in frame.structures or getattr(frame, name, None) is not None

    def span(self, frame: Frame) -> tuple[float, float]:
        """Return what the first and the last colour of the map stand for, unless others are chosen.

        Raises ValueError for a view without a range."""
        raise ValueError(f"the view {self.label} has no range")


class View(StrEnum):
    """The views, by the names that commands and saved pictures use, in the order of menus."""

    COLOR = "color"
    OCCLUSION = "occlusion"
    SHADOW = "shadow"
    PRIMITIVE = "primitive"
    DEPTH = "depth"
    NORMAL = "normal"
    PIXEL_COUNT = "pixel-count"
    DIFFERENCE = "difference"
    WIPE = "wipe"
    CERTIFICATE = "certificate"
    SAVED = "saved"
    COST = "cost"
    PENUMBRA = "penumbra"
    LIGHTS = "lights"
    CUTS = "cuts"
    VOXELS = "voxels"
    CELL_LIGHTS = "cell-lights"
    FATE = "fate"
    MOVING_SHADOW = "moving-shadow"
    SLACK = "slack"
    REGRET = "regret"

    # What its file declares can be asked of the name.
    label: str
    key: str
    help: str
    records: Record | None
    of_light: bool
    of_modes: bool
    has_range: bool
    has_slice: bool
    is_flat: bool
    shows_picture: bool
    shows_clipped: bool
    asks: Callable[..., dict[str, Any]] | None

    if not TYPE_CHECKING:  # so that other names are found out

        def __getattr__(self, name):
            if name.startswith("_"):
                raise AttributeError(name)
            return getattr(self.declared, name)

    @property
    def declared(self) -> Declaration:
        """What its file in `viewer/views` declares."""
        return _declared(self.value)


@cache
def _declared(name: str) -> Declaration:
    found: Declaration = import_module(f"viewer.views.{name.replace('-', '_')}").VIEW
    return found


def can_record_lights(pixels: int, lights: int) -> bool:
    """Return whether there is memory for what each light sends to each pixel."""
    return pixels * lights <= MOST_RECORDED


def recording(view: View, pixels: int, lights: int) -> dict[str, Any]:
    """Return the settings by which frames of so many pixels record what a view shows, as far as there is memory."""
    fits = can_record_lights(pixels, lights)
    few = lights <= MOST_TOGETHER or not view.of_light
    possible = {Record.VERIFY: True, Record.WORK: True, Record.LIGHTS: few and fits, Record.FATES: fits}
    return {one.value: view.records is one and there for one, there in possible.items()}


def has_modes_of_cells(frame: Frame) -> bool:
    """Return whether what carries modes are virtual cells."""
    return frame.cells is not None and frame.certificates is None


def can_draw(frame: Frame, view: View, light: int = 0) -> bool:
    """Return whether the frame holds what the view shows, of this light where it is about one."""
    return view.declared.can_draw(frame, light)
