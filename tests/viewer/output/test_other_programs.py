"""What goes to the clipboard, and to tev: read here by a server that knows nothing of our own code."""

from __future__ import annotations

import socket
import stat
import struct
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM, run
from viewer.output import other_programs


class Server:
    """Listens as tev does, and puts together the images that it is told of."""

    def __init__(self) -> None:
        self.images: dict[str, dict[str, np.ndarray]] = {}
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        connection, _ = self._socket.accept()
        with connection, connection.makefile("rb") as stream:
            while head := stream.read(4):
                (length,) = struct.unpack("<I", head)
                self._take(stream.read(length - 4))

    def _take(self, packet: bytes) -> None:
        kind, rest = packet[0], packet[2:]  # the second says whether to come to the front
        name, rest = self._text(rest)
        if kind == 4:
            width, height, count = struct.unpack_from("<iii", rest)
            rest = rest[12:]
            self.images[name] = {}
            for _ in range(count):
                channel, rest = self._text(rest)
                self.images[name][channel] = np.full((height, width), np.nan, np.float32)
            assert rest == b""
            return
        assert kind == 6
        (count,) = struct.unpack_from("<i", rest)
        rest, channels = rest[4:], []
        for _ in range(count):
            channel, rest = self._text(rest)
            channels.append(channel)
        x, y, width, height = struct.unpack_from("<iiii", rest)
        offsets = struct.unpack_from(f"<{count}q", rest, 16)
        strides = struct.unpack_from(f"<{count}q", rest, 16 + 8 * count)
        data = np.frombuffer(rest[16 + 16 * count :], "<f4")
        for channel, offset, stride in zip(channels, offsets, strides):
            plane = data[offset : offset + stride * width * height : stride].reshape(height, width)
            self.images[name][channel][y : y + height, x : x + width] = plane

    @staticmethod
    def _text(data: bytes) -> tuple[str, bytes]:
        text, _, rest = data.partition(b"\0")
        return text.decode(), rest

    def close(self) -> None:
        self._thread.join(10.0)
        self._socket.close()
        assert not self._thread.is_alive()


@pytest.fixture
def server() -> Iterator[Server]:
    server = Server()
    yield server
    server._socket.close()


def test_render_sends_all_channels(
    server: Server, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(other_programs, "_LARGEST", 700)  # so that it comes in several packets
    (tmp_path / "größe.aff").write_text(ROOM)
    options = ("--to-tev", f"127.0.0.1:{server.port}", "--buffers", tmp_path / "a.npz", "--size", "32x24")
    assert run(capfd, "render", tmp_path / "größe.aff", *options)[0] == 0
    server.close()
    image = server.images["größe 0 s paper"]
    with np.load(tmp_path / "a.npz") as arrays:
        for axis, letter in enumerate("RGB"):
            assert np.array_equal(image[letter], arrays["color"][..., axis])
        assert np.array_equal(image["Z"], arrays["depth"])
        assert np.array_equal(image["primitive"], arrays["primitive"].astype(np.float32)), "-1 for a miss"
        assert np.array_equal(image["lit.1"], arrays["lit"][..., 1])
    assert image["occlusion_mode"].min() == -1.0 and not any(np.isnan(plane).any() for plane in image.values())


def test_addresses() -> None:
    assert other_programs.address("host:99") == ("host", 99) and other_programs.address(":99") == ("127.0.0.1", 99)
    assert other_programs.address("host") == ("host", 14158) and other_programs.address("[::1]:5") == ("::1", 5)
    for wrong in ("host:", "host:x", "host:0", "host:70000"):
        with pytest.raises(ValueError, match="is not an address"):
            other_programs.address(wrong)


def test_the_clipboard_is_that_of_the_desktop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("DISPLAY", ":9")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert other_programs.clipboard_command() is None
    with pytest.raises(OSError, match="install xclip"):
        other_programs.copy(b"png")
    for name in ("xclip", "wl-copy"):
        program = tmp_path / name
        program.write_text(f'#!/bin/sh\nwhile read -r line; do echo "{name} $* $line" > {tmp_path}/got; done\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
    other_programs.copy(b"png\n")
    assert (tmp_path / "got").read_text() == "xclip -selection clipboard -target image/png -in png\n"
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    other_programs.copy(b"png\n")
    assert (tmp_path / "got").read_text() == "wl-copy --type image/png png\n"
    (tmp_path / "wl-copy").write_text("#!/bin/sh\nexit 3\n")
    with pytest.raises(OSError, match="wl-copy failed with code 3"):
        other_programs.copy(b"png")
