"""The root file of a scene: its camera, its animation and a flight through it; geometry and lights are included."""

from __future__ import annotations

from generate import materials as m
from generate.aff import number, numbers
from generate.tracks import Flight


def root_file(
    comments: tuple[str, ...], background: tuple[float, ...], angle: float, included: str, flight: Flight, frames: int
) -> str:
    """The text of a root file that includes `included`, flown through in so many frames from time 0 on.

    `angle` is the camera's angle of view in degrees."""
    position, target = flight.at(0.0)
    duration = float(flight.times[-1])
    return "\n".join([
        *(f"# {line}" for line in comments),
        "",
        f"b {numbers(background)}",
        f"am {numbers((m.GLOBAL_AMBIENT,) * 3)}",
        "v",
        f"from {numbers(position)}",
        f"at {numbers(target)}",
        "up 0 1 0",
        f"angle {number(angle)}",
        "hither 0.01",
        "resolution 800 600",
        "",
        f"a 0 {number(duration)} {frames}",
        "",
        f"i 0 {included}",
        "",
        flight.text(0.0, duration, round(duration * 2) + 1),
    ]) + "\n"  # fmt: skip
