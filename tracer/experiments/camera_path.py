"""The frames of a film: along a scene's own path, or smoothly through stops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Camera, Scene

MOST_FRAMES = 100_000
_BETWEEN_STOPS = 400  # points of the curve between two stops, by which its length is measured


@dataclass(frozen=True)
class Stop:
    """A camera to fly through, at `time` seconds of the scene."""

    time: float
    camera: Camera


@dataclass(frozen=True)
class Take:
    """A frame of a film.

    Attributes
    ----------
    time : float
        The scene's time, in seconds.
    camera : Camera or None
        None for the scene's own.
    number : int or None
        Its number on the scene's path, None where it is no frame of it.
    """

    time: float
    camera: Camera | None
    number: int | None = None


def along_path(
    scene: Scene, first: int, last: int, frames: int | None = None, camera: Camera | None = None
) -> list[Take]:
    """Take the frames of a scene's path.

    Parameters
    ----------
    scene : Scene
        The scene.
    first, last : int
        Numbers of the first and the last frame.
    frames : int, optional
        So many, at even distances of time, instead of each frame between these once.
    camera : Camera, optional
        The camera, instead of the scene's own.

    Returns
    -------
    list of Take
        In their order.

    Raises
    ------
    ValueError
        If there are no such frames, or if they are too many or too few.
    """
    if not 0 <= first <= last < scene.frames:
        only = "is 0" if scene.frames == 1 else f"are 0 to {scene.frames - 1}"
        raise ValueError(f"frames {first} to {last}: the scene's frame numbers {only}")
    if frames is None or frames == last - first + 1:
        return [Take(scene.frame_time(n), camera, n) for n in range(first, last + 1)]
    _check(frames)
    return [Take(float(time), camera) for time in np.linspace(scene.frame_time(first), scene.frame_time(last), frames)]


def through(stops: Sequence[Stop], frames: int) -> list[Take]:
    """Fly through stops on a smooth curve, at an even speed.

    Turning counts as moving: by one radian as much as by the mean distance between two stops.

    Parameters
    ----------
    stops : sequence of Stop
        Two or more; the first and the last are the film's first and last frame.
    frames : int
        How many frames the film has.

    Returns
    -------
    list of Take
        In their order.

    Raises
    ------
    ValueError
        If there are too few stops, or too many or too few frames.
    """
    if len(stops) < 2:
        raise ValueError("a film through bookmarks needs two of them at least")
    _check(frames)
    rows = np.array([[*s.camera.position, *s.camera.basis()[2], *s.camera.basis()[1], s.camera.angle, s.time]
                     for s in stops])  # fmt: skip
    curve = np.concatenate([_catmull_rom(rows, n) for n in range(len(stops) - 1)] + [rows[-1:]])
    way = _way(curve, np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1).mean())
    if way[-1] == 0.0:  # all at one place: time alone goes on
        way = np.linspace(0.0, 1.0, len(curve))
    at = np.linspace(0.0, way[-1], frames)
    even = np.stack([np.interp(at, way, column) for column in curve.T], axis=-1).tolist()
    takes = [Take(row[10], Camera(tuple(row[:3]), tuple(row[3:6]), tuple(row[6:9]), row[9])) for row in even]
    takes[0], takes[-1] = (Take(stop.time, stop.camera) for stop in (stops[0], stops[-1]))
    return takes


def _check(frames: int) -> None:
    if not 2 <= frames <= MOST_FRAMES:
        raise ValueError(f"a film has 2 to {MOST_FRAMES:,} frames, not {frames:,}")


def _catmull_rom(rows: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """Return the curve (_BETWEEN_STOPS, 11) from stop n to the next, without its end.

    It is a Catmull-Rom spline for where the camera is and looks, and a straight line for angle and time, which must not
    overshoot."""
    before, start, end, after = (rows[min(max(n + k, 0), len(rows) - 1)] for k in (-1, 0, 1, 2))
    t = np.linspace(0.0, 1.0, _BETWEEN_STOPS, endpoint=False)[:, None]
    into, out = 0.5 * (end - before), 0.5 * (after - start)
    h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, 3 * t**2 - 2 * t**3, t**3 - t**2)
    curve = h[0] * start + h[1] * into + h[2] * end + h[3] * out
    curve[:, 9:] = start[9:] + t * (end[9:] - start[9:])
    for part in (slice(3, 6), slice(6, 9)):  # a direction: of length 1 again, and never none
        length = np.linalg.norm(curve[:, part], axis=1, keepdims=True)
        curve[:, part] = np.where(length < 1e-3, end[part], curve[:, part] / np.maximum(length, 1e-3))
    return curve


def _way(curve: NDArray[np.float64], radian: float) -> NDArray[np.float64]:
    """Return how far (n,) it is to each point of a curve, where a turn by one radian is so far."""
    moved, *turned = (np.linalg.norm(np.diff(curve[:, i : i + 3], axis=0), axis=1) for i in (0, 3, 6))
    return np.concatenate([[0.0], np.cumsum(np.hypot(moved, (radian or 1.0) * np.maximum(*turned)))])
