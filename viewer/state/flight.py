"""The frames of a film: when and from where each is taken, along the scene's own path or through bookmarks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Camera, Scene

MOST_FRAMES = 100_000
LEG = 2.0
"""Seconds from one bookmark to the next, where nothing else is said."""
_FINE = 400  # points between two bookmarks, by which the way is measured


@dataclass(frozen=True)
class Stop:
    """A place to fly through, and the scene's time there."""

    time: float
    camera: Camera


@dataclass(frozen=True)
class Take:
    """A frame of a film: its camera is the scene's own where that is None; `warmup` is how many frames of the scene's
    path come before it in the film, None where those before it are others, and `number` its number on that path, None
    where it is no frame of it."""

    time: float
    camera: Camera | None
    warmup: int | None = None
    number: int | None = None


def along_path(
    scene: Scene, first: int, last: int, frames: int | None = None, camera: Camera | None = None
) -> list[Take]:
    """The scene's frames `first` to `last`, or so many `frames` at even distances of time between these.

    Raises ValueError, in one line, for frames that there are not."""
    if not 0 <= first <= last < scene.frames:
        only = "is 0" if scene.frames == 1 else f"are 0 to {scene.frames - 1}"
        raise ValueError(f"frames {first} to {last}: the scene's frame numbers {only}")
    if frames is None or frames == last - first + 1:
        return [Take(scene.frame_time(n), camera, n - first, n) for n in range(first, last + 1)]
    _check(frames)
    start, end = scene.frame_time(first), scene.frame_time(last)
    return [Take(float(time), camera) for time in np.linspace(start, end, frames)]


def through(stops: Sequence[Stop], frames: int) -> list[Take]:
    """So many frames through bookmarks, at an even speed: a smooth way, of which each frame goes on as far.

    Turning counts as moving: by one radian as much as by the mean way between two bookmarks.  Raises ValueError where
    there are fewer than two stops."""
    if len(stops) < 2:
        raise ValueError("a film through bookmarks needs two of them at least")
    _check(frames)
    rows = np.array([_row(stop) for stop in stops])
    fine = np.concatenate([_span(rows, n) for n in range(len(stops) - 1)] + [rows[-1:]])
    way = _measured(fine, np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1).mean())
    if way[-1] == 0.0:  # all at one place: time alone goes on
        way = np.linspace(0.0, 1.0, len(fine))
    at = np.linspace(0.0, way[-1], frames)
    found = np.stack([np.interp(at, way, column) for column in fine.T], axis=-1)
    found[0], found[-1] = rows[0], rows[-1]
    takes = [_take(row) for row in found]
    takes[0], takes[-1] = (Take(stop.time, stop.camera) for stop in (stops[0], stops[-1]))
    return takes


def _check(frames: int) -> None:
    if not 2 <= frames <= MOST_FRAMES:
        raise ValueError(f"a film has 2 to {MOST_FRAMES:,} frames, not {frames:,}")


def _row(stop: Stop) -> NDArray[np.float64]:
    """(11,) position, forward, up, angle and time."""
    _, up, forward = stop.camera.basis()
    return np.array([*stop.camera.position, *forward, *up, stop.camera.angle, stop.time])


def _take(row: NDArray[np.float64]) -> Take:
    position, forward, up = (tuple(float(x) for x in row[i : i + 3]) for i in (0, 3, 6))
    return Take(float(row[10]), Camera(position, forward, up, float(row[9])))  # type: ignore[arg-type]


def _span(rows: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """(_FINE, 11) the way from bookmark n to the next, without its end: a Catmull-Rom curve for where the camera is and
    looks, a straight line for angle and time, which must not overshoot."""
    before, start, end, after = (rows[min(max(n + k, 0), len(rows) - 1)] for k in (-1, 0, 1, 2))
    t = np.linspace(0.0, 1.0, _FINE, endpoint=False)[:, None]
    into, out = 0.5 * (end - before), 0.5 * (after - start)
    h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, 3 * t**2 - 2 * t**3, t**3 - t**2)
    curve = h[0] * start + h[1] * into + h[2] * end + h[3] * out
    curve[:, 9:] = start[9:] + t * (end[9:] - start[9:])
    straight = start + t * (end - start)
    for i in (3, 6):  # a direction: of length 1 again, and never none
        lost = np.linalg.norm(curve[:, i : i + 3], axis=1) < 1e-3
        curve[lost, i : i + 3] = straight[lost, i : i + 3]
        lengths = np.linalg.norm(curve[:, i : i + 3], axis=1)
        curve[:, i : i + 3] = np.where(
            lengths[:, None] < 1e-3, end[i : i + 3], curve[:, i : i + 3] / np.maximum(lengths, 1e-3)[:, None]
        )
    return curve


def _measured(fine: NDArray[np.float64], radian: float) -> NDArray[np.float64]:
    """(n,) how far it is to each point of the way; a turn by one radian is so far."""
    moved = np.linalg.norm(np.diff(fine[:, :3], axis=0), axis=1)
    turned = np.maximum(*(np.linalg.norm(np.diff(fine[:, i : i + 3], axis=0), axis=1) for i in (3, 6)))
    return np.concatenate([[0.0], np.cumsum(np.hypot(moved, (radian or 1.0) * turned))])
