"""Pictures to other programs: the desktop's clipboard, and tev or HDRView.

tev is told of images by packets on a TCP connection.  A packet is its own length in bytes, as 32 bits, then its kind,
and what belongs to that; all little endian, and texts end with a zero (https://github.com/Tom94/tev, `Ipc.h`)."""

from __future__ import annotations

import os
import shutil
import socket
import struct
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.output.exr import MISS, channels

_CLIPBOARDS = {
    "wl-copy": ("WAYLAND_DISPLAY", ["--type", "image/png"]),
    "xclip": ("DISPLAY", ["-selection", "clipboard", "-target", "image/png", "-in"]),
}
NO_CLIPBOARD = "the picture cannot be copied: install xclip, or wl-clipboard where the desktop is Wayland"
PORT = 14158
TIMEOUT = 10.0  # seconds
CREATE, UPDATE = 4, 6  # of tev's EPacketType: CreateImage, UpdateImageV3
_LARGEST = 1 << 22  # bytes of pixels in a packet


def clipboard_command() -> list[str] | None:
    """Return the command that takes a PNG on its standard input; None where there is none."""
    for name, (display, options) in _CLIPBOARDS.items():
        found = shutil.which(name)
        if found and os.environ.get(display):
            return [found, *options]
    return None


def copy(png: bytes) -> None:
    """Put a PNG on the clipboard; raises OSError in one line.

    The program is spawned, not forked: a copy of this process, with its window and its threads, is none to go on in."""
    command = clipboard_command()
    if command is None:
        raise OSError(NO_CLIPBOARD)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        file.write_bytes(png)
        actions = [
            (os.POSIX_SPAWN_OPEN, 0, str(file), os.O_RDONLY, 0),
            (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
            (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
        ]
        process = os.posix_spawn(command[0], command, os.environ, file_actions=actions)
        _, status = os.waitpid(process, 0)  # both go on in the background by themselves
    code = os.waitstatus_to_exitcode(status)
    if code:
        raise OSError(f"the picture was not copied: {Path(command[0]).name} failed with code {code}")


def address(text: str) -> tuple[str, int]:
    """Return host and port of "host:port", "host" or ":port"; raises ValueError in one line."""
    host, colon, port = text.strip().rpartition(":")
    if not colon:
        host, port = port, str(PORT)
    if not port.isascii() or not port.isdigit() or not 0 < int(port) < 1 << 16:
        raise ValueError(f"{text!r} is not an address; give host:port, like 127.0.0.1:{PORT}")
    return host.strip("[]") or "127.0.0.1", int(port)


def send(to: tuple[str, int], name: str, frame: Frame) -> None:
    """Show a frame's colours and buffers in the program that listens there, as an image of that name.

    Raises OSError in one line."""
    try:
        with socket.create_connection(to, TIMEOUT) as connection:
            for packet in packets(name, planes(frame)):
                connection.sendall(packet)
            connection.shutdown(socket.SHUT_WR)
    except OSError as error:
        why = error.strerror or str(error) or type(error).__name__
        raise OSError(f"nothing sent to {to[0]}:{to[1]}: {why}; is tev or HDRView open there?") from None


def planes(frame: Frame) -> dict[str, NDArray[np.float32]]:
    """Return (h, w) float32 by the names of channels, as EXR has them; whole numbers as floats, -1 for a miss."""
    found = {}
    for name, plane in channels(frame).items():
        values = plane.astype(np.float32)
        found[name] = np.where(plane == MISS, np.float32(-1.0), values) if plane.dtype == np.uint32 else values
    return found


def packets(name: str, named: Mapping[str, NDArray[np.float32]]) -> Iterator[bytes]:
    """What is sent of an image with these channels, each (h, w): that there is one, and its pixels, rows at a time."""
    height, width = next(iter(named.values())).shape
    names = b"".join(_text(channel) for channel in named)
    yield _packet(CREATE, b"\1" + _text(name) + struct.pack("<iii", width, height, len(named)) + names)
    rows = max(1, _LARGEST // (4 * width * len(named)))
    for top in range(0, height, rows):
        parts = [np.ascontiguousarray(plane[top : top + rows], "<f4") for plane in named.values()]
        pixels = parts[0].size
        place = struct.pack("<iiii", 0, top, width, parts[0].shape[0])
        offsets = b"".join(struct.pack("<q", number * pixels) for number in range(len(parts)))
        strides = struct.pack("<q", 1) * len(parts)
        head = b"\0" + _text(name) + struct.pack("<i", len(parts)) + names + place + offsets + strides
        yield _packet(UPDATE, head + b"".join(part.tobytes() for part in parts))


def _text(text: str) -> bytes:
    return text.replace("\0", " ").encode(errors="replace") + b"\0"


def _packet(kind: int, content: bytes) -> bytes:
    return struct.pack("<IB", 5 + len(content), kind) + content
