"""Is there a screen?  Asked before anything of GL is imported, and answered by knocking, not by trust.

`DISPLAY` may be left over from a session that has ended, or be set in a container that has no X
server; a window library then fails deep inside C.  So the answer is yes only where a server
accepts a connection."""

from __future__ import annotations

import os
import re
import socket
import sys
from pathlib import Path

_TIMEOUT = 2.0  # seconds; a forwarded display answers within one round trip


def has_display() -> bool:
    """True where a window can be opened: an X or a Wayland server that listens (elsewhere than Linux: always)."""
    if not sys.platform.startswith(("linux", "freebsd")):
        return True
    wayland = os.environ.get("WAYLAND_DISPLAY", "")
    runtime = Path(os.environ.get("XDG_RUNTIME_DIR", "/"))
    return has_x_display() or (bool(wayland) and _listens(socket.AF_UNIX, str(runtime / wayland)))


def has_x_display() -> bool:
    """True where `DISPLAY` names an X server that listens."""
    match = re.fullmatch(r"(?:(?P<host>[^/]*?)(?:/\w+)?):(?P<number>\d+)(?:\.\d+)?", os.environ.get("DISPLAY", ""))
    if not match:
        return False
    host, number = match["host"], int(match["number"])
    if host not in ("", "unix"):
        return _listens(socket.AF_INET, (host, 6000 + number))
    path = f"/tmp/.X11-unix/X{number}"
    return _listens(socket.AF_UNIX, path) or _listens(socket.AF_UNIX, "\0" + path)


def no_display_reason() -> str:
    """Why there is no screen, for a message: nothing is set, or what is set does not answer."""
    named = [f"{name}={os.environ[name]}" for name in ("DISPLAY", "WAYLAND_DISPLAY") if os.environ.get(name)]
    return f"no display ({' and '.join(named)} does not answer)" if named else "no display"


def _listens(family: int, address: str | tuple[str, int]) -> bool:
    try:
        with socket.socket(family, socket.SOCK_STREAM) as connection:
            connection.settimeout(_TIMEOUT)
            connection.connect(address)
        return True
    except OSError:
        return False
