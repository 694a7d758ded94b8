"""The modes that a picture's shadow testing went by, as text that the picture carries.

Where the frames that taught them cannot be traced again, as pictures in motion, of which only some pixels were shaded,
these modes are all that the picture depends on besides its state.
"""

from __future__ import annotations

import base64
import zlib

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.method import Method
from viewer.output.commands import needs_history
from viewer.state.view_state import ViewState

LARGEST = 1 << 20
"""Bytes of the text, at most: pictures of more modes do without them."""


def suffice(state: ViewState) -> bool:
    """Whether modes are all that its history means to the picture: other methods learn more, and views of modes show
    what the frame itself has taught, which depends on more."""
    method = Method.parse(state.settings.method)
    return method.uses_modes and len(method.kinds) == 1 and not state.draw.view.of_modes and needs_history(state)


def packed(frame: Frame, state: ViewState) -> str:
    """What `unpacked` makes the modes of again; empty where they are not needed, or do not suffice."""
    if not state.warmup.unknown or not suffice(state):
        return ""
    words = np.ascontiguousarray(frame.modes_before)
    text = base64.b64encode(zlib.compress(words.astype(words.dtype.newbyteorder("<")).tobytes(), 6)).decode()
    return text if len(text) <= LARGEST else ""


def unpacked(text: str, units: int, word: np.dtype) -> NDArray[np.unsignedinteger]:
    """(units,) words; raises ValueError, in one line, where the text is no such modes."""
    size = units * word.itemsize
    try:
        inflating = zlib.decompressobj()
        data = inflating.decompress(base64.b64decode(text, validate=True), size + 1)
    except (ValueError, zlib.error):
        raise ValueError("its modes are damaged") from None
    if len(data) != size or not inflating.eof:
        raise ValueError(f"its modes are not those of {units:,} primitives, as the scene has them now")
    return np.frombuffer(data, word.newbyteorder("<")).astype(word)
