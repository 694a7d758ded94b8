"""Run a command with a screen: the one that is there, else a virtual one that lives as long as the command.

    python tools/with_screen.py COMMAND [ARGUMENT ...]

Where there is no X display, Xvfb serves.  If it or the libraries that a window needs are missing,
Debian's packages are installed as root or by a sudo that asks nothing.  Where that cannot be
done, the packages are named in one line and the command runs without a screen, so that everything
that needs none is still done; with `CI` set the command is not run, as nobody would read the line.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from viewer.util.screen import has_x_display

SCREEN = "1600x1000x24"
# What imgui-bundle links to (X11, Xext), what GLFW opens by itself (the other X libraries, GL, EGL), and
# Mesa's software renderer.
LIBRARIES = {
    "libX11.so.6": "libx11-6",
    "libX11-xcb.so.1": "libx11-xcb1",
    "libXext.so.6": "libxext6",
    "libXrandr.so.2": "libxrandr2",
    "libXinerama.so.1": "libxinerama1",
    "libXcursor.so.1": "libxcursor1",
    "libXi.so.6": "libxi6",
    "libXrender.so.1": "libxrender1",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libOpenGL.so.0": "libopengl0",
}


def say(line: str) -> None:
    print(f"shadowcull: {line}", file=sys.stderr, flush=True)


def missing_packages() -> list[str]:
    """Debian's names of what a virtual screen with GL lacks here."""
    missing = [] if shutil.which("Xvfb") else ["xvfb"]
    for library, package in LIBRARIES.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            missing.append(package)
    drivers = ("swrast_dri.so", "libdril_dri.so", "kms_swrast_dri.so")
    if not any(next(Path("/usr").glob(f"lib*/{mid}dri/{driver}"), None) for driver in drivers for mid in ("", "*/")):
        missing.append("libgl1-mesa-dri")
    return missing


def install(packages: list[str]) -> bool:
    """Install Debian's packages where no password is needed; false where that cannot be done."""
    if not shutil.which("apt-get"):
        return False
    prefix = []
    if os.geteuid() != 0:
        if not shutil.which("sudo") or subprocess.run(["sudo", "-n", "true"], capture_output=True).returncode:
            return False
        prefix = ["sudo", "-n"]
    say(f"installing {' '.join(packages)} for a virtual screen")
    apt = [*prefix, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q", "-y", "-o", "DPkg::Lock::Timeout=300"]
    for arguments in (["update"], ["install", "--no-install-recommends", *packages]):
        done = subprocess.run([*apt, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode:
            lines = (done.stderr or done.stdout).strip().splitlines()
            say(f"apt-get {arguments[0]} failed: {lines[-1] if lines else f'exit code {done.returncode}'}")
            # A failed update is no reason to stop: the lists may be good enough.
            if arguments[0] == "install":
                return False
    return True


def start_screen() -> tuple[subprocess.Popen, str] | None:
    """Start Xvfb on a display number that it finds free itself; None, with one line said, if it will not start."""
    read, write = os.pipe()
    log = Path(os.environ.get("SHADOWCULL_CACHE_DIR", "/tmp")).parent / "xvfb.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as output:
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp", "-noreset"],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            pass_fds=[write],
            start_new_session=True,  # Ctrl-C goes to the command; the server stays until that has ended
        )
    os.close(write)
    with os.fdopen(read) as pipe:  # reads nothing, at once, if the server dies
        number = pipe.readline().strip()
    if not number:
        server.wait()
        say(f"Xvfb does not start, see {log}")
        return None
    return server, f":{number}"


def main() -> int:
    command = sys.argv[1:]
    if not command or command[0] in ("-h", "--help"):
        print(__doc__, file=sys.stderr)
        return 2
    environment = dict(os.environ)
    server = None
    if not has_x_display():
        environment.pop("DISPLAY", None)
        environment.pop("WAYLAND_DISPLAY", None)
        missing = missing_packages()
        if missing and install(missing):
            missing = missing_packages()
        started = None
        if missing:
            say(f"no display, and none can be made: run 'apt-get install {' '.join(missing)}' as root")
        else:
            started = start_screen()
        if started:
            server, environment["DISPLAY"] = started
            environment.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
        elif environment.get("CI"):
            return 1
    try:
        # A signal from the terminal reaches the command too; wait for how it ends.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        child = subprocess.Popen(command, env=environment, preexec_fn=_default_interrupt)
        signal.signal(signal.SIGTERM, lambda *_: child.terminate())
        code = child.wait()
        return 128 - code if code < 0 else code
    finally:
        if server:
            server.terminate()
            server.wait()


def _default_interrupt() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)


if __name__ == "__main__":
    sys.exit(main())
