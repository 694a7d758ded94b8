"""A frame with all its buffers as an OpenEXR file, and what it carries as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.frame import Frame
from viewer.output.capture import CHUNK, CaptureError, Carried, carried_from_text
from viewer.util.files import whole_file

ENDING = ".exr"
MOST_LIGHTS = 32  # that have channels of their own
MISS = np.uint32(0xFFFFFFFF)
"""In a channel of whole numbers: nothing is there."""
_AXES = {"color": "RGB", "reference": "RGB", "normal": "XYZ"}
_NAMES = {"color": "", "normal": "N.", "depth": "Z"}


def check() -> None:
    """Raise ValueError, in one line, where OpenEXR is not there."""
    try:
        import OpenEXR  # noqa: F401
    except ImportError as error:
        raise ValueError(f"an {ENDING} needs OpenEXR; install shadowcull[exr] ({error})") from None


def channels(frame: Frame, half: bool = False) -> dict[str, NDArray[Any]]:
    """Return (h, w) arrays by the names of channels, float32, float16 where `half`, or uint32."""
    found: dict[str, NDArray[Any]] = {}
    kind = np.float16 if half else np.float32
    for name, array in (buffers(frame) | {"normal": frame.normal}).items():
        if name in _AXES:
            for axis, letter in enumerate(_AXES[name]):
                found[f"{_NAMES.get(name, name + '.')}{letter}"] = array[..., axis].astype(kind)
        elif array.ndim == 3:
            found |= {f"{name}.{light}": array[..., light] for light in range(min(array.shape[-1], MOST_LIGHTS))}
        else:
            found[_NAMES.get(name, name)] = array
    whole = {name: _whole(array) for name, array in found.items() if array.dtype.kind != "f"}
    return {name: np.ascontiguousarray(array) for name, array in (found | whole).items()}


def _whole(array: NDArray[Any]) -> NDArray[np.uint32]:
    """Whole numbers as EXR has them; what stands for a miss, -1 or 255, is MISS."""
    whole = array.astype(np.uint32)
    return np.where(array == 255, MISS, whole) if array.dtype == np.uint8 else whole


def write(path: Path, frame: Frame, text: str, half: bool = False) -> None:
    """Write the file, whole or not at all; raises OSError in one line."""
    import OpenEXR

    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "software": "Shadowcull",
        CHUNK: text,
    }
    with whole_file(path) as (part, _):
        try:
            with OpenEXR.File(header, channels(frame, half)) as file:
                file.write(str(part))
            with OpenEXR.File(str(part)) as file:  # the library says nothing where the last bytes have no room
                file.channels()
        except RuntimeError as error:
            raise OSError(f"is the disk full? {str(error).replace(str(part), str(path))}") from None


def read(path: Path) -> tuple[NDArray[Any], Carried]:
    """Return the colours, (h, w, 3), and what the file carries; raises CaptureError."""
    import OpenEXR

    if not path.is_file():
        raise CaptureError(f"{path}: no such file")
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            text = file.header().get(CHUNK)
            color = np.stack([file.channels()[letter].pixels for letter in "RGB"], axis=-1)
    except (RuntimeError, KeyError, ValueError) as error:
        raise CaptureError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(text, str):
        raise CaptureError(f"{path}: an EXR, but not one saved by Shadowcull")
    return color, carried_from_text(path, text)


def buffers(frame: Frame) -> dict[str, NDArray[Any]]:
    """Return the arrays of `--buffers`, by name: those that the frame has recorded.

    A verified frame has `reference` and `wrong`, one with certificates `certificate`, and one that recorded its work
    `saved`, `cost` and `due_rays`."""
    names = ("color", "depth", "primitive", "cell", "occlusion_mode", "shadow_mode", "lit", "due", "reference", "wrong",
             "saved", "cost", "due_rays")  # fmt: skip
    arrays = {name: array for name in names if (array := getattr(frame, name)) is not None}
    if frame.certificates is not None:
        planes = [modes.shadow_mode(frame.certificates, light) for light in range(frame.lights)]
        arrays["certificate"] = np.stack(planes, axis=-1) if planes else np.empty((*frame.primitive.shape, 0), np.uint8)
    return arrays
