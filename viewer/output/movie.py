"""A film as files: numbered pictures, and a video of them where that is wanted and PyAV is there."""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

VIDEO = ".mp4"
QUALITY = "16"  # of x264: what the eye can hardly tell from the pictures
NEEDS_PYAV = "a video needs PyAV; install shadowcull[video] (pip install av), or give a folder for the pictures alone"


def check_video() -> None:
    """Raise ValueError, in one line, where no video can be written."""
    try:
        import av
    except ImportError as error:
        raise ValueError(f"{NEEDS_PYAV} ({error})") from None
    if "libx264" not in av.codecs_available:
        raise ValueError("PyAV was built without x264; give a folder for the pictures alone")


def frame_name(number: int, last: int) -> str:
    """The name of a picture by its number; as long for all up to the last."""
    return f"{number:0{max(4, len(str(last)))}d}.png"


class Video:
    """An mp4 that frames are added to; closed, it takes its name, and may be shorter than was planned.

    x264 takes even sizes only: an odd side is made even by its last row or column once more."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float) -> None:
        """`size` is that of the pictures.  Raises OSError in one line."""
        import av

        self.path, self._part = path, path.with_name(f".{path.name}.{os.getpid()}.part")
        self.size = size[0] + size[0] % 2, size[1] + size[1] % 2
        self.frames = 0
        try:
            self._file: Any = av.open(str(self._part), "w", format="mp4", options={"movflags": "+faststart"})
        except OSError as error:
            raise OSError(f"{path}: not written: {error.strerror or error}") from None
        rate = Fraction(fps).limit_denominator(1001)
        self._stream: Any = self._file.add_stream("libx264", rate=rate, options={"crf": QUALITY, "preset": "medium"})
        self._stream.width, self._stream.height = self.size
        self._stream.pix_fmt = "yuv420p"
        context = self._stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = 1  # BT.709, as players take it to be
        context.color_range = 1  # of studios

    def add(self, pixels: NDArray[np.uint8]) -> None:
        """The next picture, (h, w, 3) uint8; raises OSError in one line."""
        import av

        height, width = pixels.shape[:2]
        room = ((0, self.size[1] - height), (0, self.size[0] - width), (0, 0))
        frame: Any = av.VideoFrame.from_ndarray(np.ascontiguousarray(np.pad(pixels, room, "edge")), format="rgb24")
        frame = frame.reformat(
            format="yuv420p", dst_colorspace="itu709", dst_color_range="MPEG", src_color_range="JPEG"
        )
        self._put(frame)
        self.frames += 1

    def _put(self, frame: Any) -> None:
        try:
            for packet in self._stream.encode(frame):
                self._file.mux(packet)
        except OSError as error:
            raise OSError(f"{self.path}: not written: {error.strerror or error}") from None

    def __enter__(self) -> Video:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the file; without a frame, or after a failure to write, none is left."""
        try:
            if self.frames and not isinstance(error, OSError):
                self._put(None)
            self._file.close()
            if self.frames and not isinstance(error, OSError):
                os.replace(self._part, self.path)
        finally:
            self._part.unlink(missing_ok=True)
