"""Pictures as files, and what a PNG remembers of how it was made.

The text chunk `shadowcull` of a saved picture holds, as JSON, its state, the camera and the frame's statistics; opening
it brings all that back.  Files are whole or absent, and every failure is one line."""

from __future__ import annotations

import string
from dataclasses import dataclass, field
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from tracer.scene.camera import Camera
from tracer.scene.files import read_regular
from tracer.scene.model import SceneError
from tracer.scene.textures import open_image
from viewer.state import codec
from viewer.state.view_state import ViewState
from viewer.util.files import write_bytes, write_new
from viewer.util.messages import in_one_line

CHUNK = "shadowcull"
FIELDS = {
    "scene": "the scene's file name",
    "view": "the view's name",
    "frame": "number of the frame, e.g. {frame:04d}",
    "seconds": "the scene's time, e.g. {seconds:.2f}",
    "method": "how shadows were traced, e.g. paper or certified+cache",
    "light": "number of the chosen light",
    "width": "width in pixels",
    "height": "height in pixels",
    "date": "today, e.g. 2024-05-31",
    "time": "now, e.g. 14-05-09",
}
TEMPLATE_HELP = "Fields:\n" + "\n".join(f"{{{name}}}  {meaning}" for name, meaning in FIELDS.items())
KINDS = {
    ".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".tif": "TIFF", ".tiff": "TIFF", ".bmp": "BMP", ".ppm": "PPM",
}  # fmt: skip
"""The kinds of pictures that `write` writes, by their endings."""
_END = b"IEND\xaeB`\x82"  # of every whole PNG
_FORBIDDEN = '<>:"/\\|?*\0'
_LONGEST_NAME = 200


class CaptureError(ValueError):
    """A picture cannot be saved or restored; the message is one line."""


@dataclass(frozen=True)
class Made:
    """What a file was made of: by which version, and fingerprints of the parts of the scene and of its own pixels."""

    version: str = ""
    scene: dict[str, str] = field(default_factory=dict)
    pixels: str = ""


@dataclass(frozen=True)
class Carried:
    """What a saved picture or figure carries, as JSON.

    `state` is stored as the codec does it; `camera` is the frame's, also where the state has the scene's own.  The
    `statistics` are those of the frame, or of each method of a `figure`.  `window` is true of what shows more than one
    picture, such as panels, and `picture` is what version 0.2 kept of how it was drawn."""

    state: dict[str, Any]
    camera: dict[str, Any] | None = None
    frame: int = 0
    size: tuple[int, int] | None = None
    statistics: dict[str, Any] = field(default_factory=dict)
    made: Made | None = None
    figure: dict[str, Any] | None = None
    window: bool | None = None
    picture: dict[str, Any] | None = None
    format: int = codec.FORMAT

    def text(self) -> str:
        """Return it as JSON."""
        return codec.text({name: value for name, value in vars(self).items() if value is not None})

    def view_state(self) -> ViewState:
        """Return the state; raises ValueError, in one line, where it is damaged."""
        found = codec.state_from_json(self.state, drawn=self.picture or self.figure)
        if not found.scene:
            raise ValueError("its saved state lacks a scene")
        if self.size is None:
            return found
        width, height = self.size
        return found.with_settings(width=width, height=height).validated()


def carried_from_json(data: Any) -> Carried:
    """Return what a file carries; raises ValueError in one line."""
    if not isinstance(data, dict) or not isinstance(data.get("state"), dict):
        raise ValueError("no saved state in it")
    return codec.from_json(data, Carried, "what it carries")


def carried_from_text(path: Path, text: str) -> Carried:
    """Return what a file carries; raises CaptureError."""
    try:
        return carried_from_json(codec.from_text(text))
    except ValueError as error:
        raise CaptureError(f"{path}: cannot be restored: {error}") from None


def filled(template: str, values: dict[str, Any], now: datetime | None = None, what: str = "name template") -> str:
    """Return the template with its fields filled in; raises CaptureError, naming what is wrong with it."""
    now = now or datetime.now()
    known = values | {"date": now.strftime("%Y-%m-%d"), "time": now.strftime("%H-%M-%S")}
    try:
        for _, name, layout, _ in string.Formatter().parse(template):
            if name is not None and name not in FIELDS:
                raise ValueError(f"there is no field {{{name}}}, but {', '.join(FIELDS)}")
            if len(layout or "") > 6 or "{" in (layout or ""):
                raise ValueError(f"{{{name}}} is laid out too wide")
        return template.format(**known).strip()
    except (ValueError, IndexError, KeyError, AttributeError, TypeError) as error:
        raise CaptureError(f"the {what} {template!r} is wrong: {error}") from None


def file_name(template: str, values: dict[str, Any], now: datetime | None = None) -> str:
    """A file's name of the template filled in; raises CaptureError, naming what is wrong with it."""
    name = filled(template, values, now)
    name = "".join("-" if c in _FORBIDDEN or ord(c) < 32 else c for c in name)
    stem = name[:-4] if name.lower().endswith(".png") else name
    if not stem.strip(" ."):
        raise CaptureError(f"the name template {template!r} gives no file name")
    return stem[:_LONGEST_NAME] + ".png"


def encoded(pixels: NDArray[np.uint8], text: str = "", kind: str = "PNG") -> bytes:
    """Return the file of (height, width, 3) pixels, row 0 at the top; a PNG carries the text."""
    file, options = BytesIO(), dict[str, Any](quality=95) if kind == "JPEG" else {}
    if kind == "PNG" and text:
        options["pnginfo"] = info = PngImagePlugin.PngInfo()
        info.add_itxt(CHUNK, text)
        info.add_text("Software", "Shadowcull")
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, kind, **options)
    return file.getvalue()


def write(path: Path, pixels: NDArray[np.uint8], text: str = "") -> None:
    """Write a picture as its ending says, one of KINDS; raises OSError in one line.

    Through memory, as Pillow, where it may write into a file itself, says nothing of a disk without room for all."""
    write_bytes(path, encoded(pixels, text, KINDS[path.suffix.lower()]))


def save(pixels: NDArray[np.uint8], text: str, folder: Path, name: str) -> Path:
    """Write a picture as a new PNG; returns its path.

    A name that is taken gets a number.  Raises CaptureError; then no half-written file is left."""
    try:
        return write_new(folder, name.removesuffix(".png"), ".png", lambda path: write(path, pixels, text))
    except (OSError, ValueError) as error:
        raise CaptureError(f"no picture saved: {error}") from None


def read(path: Path) -> ViewState:
    """Return the state that a picture carries; raises CaptureError."""
    return restored(path, read_carried(path))


def read_camera(path: Path) -> tuple[float, Camera]:
    """Return the time and the camera of a picture; raises CaptureError."""
    carried = read_carried(path)
    state = restored(path, carried)
    try:
        return state.time, state.camera or Camera.from_json(carried.camera or carried.state["camera"])
    except (ValueError, KeyError, TypeError) as error:
        raise CaptureError(f"{path}: cannot be restored: {error}") from None


def restored(path: Path, carried: Carried) -> ViewState:
    """Return the state of what a picture carries; raises CaptureError."""
    try:
        return carried.view_state()
    except ValueError as error:
        raise CaptureError(f"{path}: cannot be restored: {error}") from None


def read_carried(path: Path) -> Carried:
    """Return all that a PNG carries; raises CaptureError."""
    try:
        file = read_regular(path)
        with open_image(BytesIO(file), ("PNG",)) as image:
            if _END not in file:
                raise ValueError("it is cut off")
            text = image.info.get(CHUNK)
            if text is None:  # another program may have put it after the pixels, which else need not be decoded
                image.load()
                text = getattr(image, "text", {}).get(CHUNK)
    except FileNotFoundError:
        raise CaptureError(f"{path}: no such file") from None
    except (SceneError, OSError, ValueError, SyntaxError) as error:
        raise CaptureError(f"{path}: cannot be read as a picture: {in_one_line(error)}") from None
    if text is None:
        raise CaptureError(f"{path}: a picture, but not one saved by Shadowcull")
    return carried_from_text(path, text)
