"""A film as files: numbered pictures, and a video of them where that is wanted and PyAV is there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from viewer.util.files import whole_file

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
    """A video that pictures are added to, as `video` opens it."""

    def __init__(self, file: Any, path: Path, size: tuple[int, int], fps: float) -> None:
        """`file` is PyAV's; `size` is that of the pictures."""
        self.path, self.size = path, (size[0] + size[0] % 2, size[1] + size[1] % 2)
        self.frames = 0
        self._file = file
        rate = Fraction(fps).limit_denominator(1001)
        self._stream: Any = file.add_stream("libx264", rate=rate, options={"crf": QUALITY, "preset": "medium"})
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
        try:
            self.put(frame)
        except OSError as error:
            raise OSError(f"{self.path}: not written: {error.strerror or error}") from None
        self.frames += 1

    def put(self, frame: Any) -> None:
        """A frame as PyAV has it, or None at the end."""
        for packet in self._stream.encode(frame):
            self._file.mux(packet)


@contextmanager
def video(path: Path, size: tuple[int, int], fps: float) -> Iterator[Video]:
    """An mp4 of pictures of this size, which takes its name at the end of the block, however many have come by then;
    without a picture, or after a failure to write, none is left.  Raises OSError in one line.

    x264 takes even sizes only: an odd side is made even by its last row or column once more."""
    import av

    stopped: BaseException | None = None
    with suppress(_Unwanted), whole_file(path) as (part, _):
        file: Any = av.open(str(part), "w", format="mp4", options={"movflags": "+faststart"})
        try:
            made = Video(file, path, size, fps)
            try:
                yield made
            except BaseException as error:
                stopped = error
            if not made.frames or isinstance(stopped, OSError):
                raise _Unwanted
            made.put(None)
        except BaseException:
            with suppress(OSError):
                file.close()
            raise
        file.close()
    if stopped is not None:
        raise stopped


class _Unwanted(Exception):
    """There is nothing to keep."""
